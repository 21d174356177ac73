// Third-party code: most of the bytes of a page. lib.js receives it after the first paint.
import embed from "vega-embed";
import { scheme } from "vega";
import { expressionInterpreter } from "vega-interpreter";
import { sankey, sankeyLinkHorizontal, sankeyJustify } from "d3-sankey";

globalThis.raywattLibraries({ embed, scheme, expressionInterpreter, sankey, sankeyLinkHorizontal, sankeyJustify });
