// What the pages use of others: most of their bytes. Handed over when it has been read, after the first paint.
import embed from "vega-embed";
import { scheme } from "vega";
import { expressionInterpreter } from "vega-interpreter";
import { sankey, sankeyLinkHorizontal, sankeyJustify } from "d3-sankey";

globalThis.raywattLibraries({ embed, scheme, expressionInterpreter, sankey, sankeyLinkHorizontal, sankeyJustify });
