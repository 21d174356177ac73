"""Mutants of a C++ source: one constant or operator changed, by tokens.

Relies on .clang-format: binary operators have blanks around them, template brackets do not.
"""

import re
from dataclasses import dataclass

TOKEN = re.compile(
    r"""(?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*|\s+)
      | (?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])')
      | (?P<number>0[xXbB][0-9a-fA-F']+[uUlL]*|(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[uUlLfF]*)
      | (?P<word>[A-Za-z_]\w*)
      | (?P<sign><<=|>>=|<=>|->|::|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
BINARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
          "+": "-", "-": "+", "*": "/", "/": "*", "%": "/", "&": "|", "|": "&", "^": "|", "<<": ">>", ">>": "<<",
          "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "^=": "|="}
WORDS = {"true": "false", "false": "true", "min": "max", "max": "min"}

# Code without effect on results; reasons in tests/mutation/README.md.
QUIET_FUNCTIONS = re.compile(r"describe\w*|state|names_of")
QUIET_CALLS = {"assert", "static_assert", "throw", "complain", "reserve", "__builtin_prefetch", "prefetch_tags_on_host",
               "format"}


@dataclass(frozen=True)
class Mutant:
    """One change: `length` characters at `begin` become `after`."""

    path: str
    line: int
    column: int
    kind: str
    begin: int
    length: int
    before: str
    after: str
    function: str

    def name(self):
        return f"{self.path}:{self.line}:{self.column} {self.kind}"

    def applied(self, source):
        return source[:self.begin] + self.after + source[self.begin + self.length:]


@dataclass
class Scope:
    """Scope of a pair of braces: file, namespace, class, enum, or function with its blocks."""

    kind: str
    function: str = ""
    quiet: bool = False


def scope_of(statement, outer):
    """Returns the scope that `{` opens after the tokens of a statement."""
    words = [text for _, text, _ in statement]
    if outer.kind == "function" or outer.quiet:
        return Scope("function", outer.function, outer.quiet)
    if "(" in words and "=" not in words:
        at = words.index("(")
        name = words[at - 1] if at else ""
        return Scope("function", name, bool(QUIET_FUNCTIONS.fullmatch(name)))
    for kind in ("namespace", "enum"):
        if kind in words:
            return Scope(kind)
    if {"class", "struct", "union"} & set(words):
        return Scope("class")
    return Scope("values", quiet=outer.kind == "class" and is_plain_default(statement))


def tokens_of(source):
    for match in TOKEN.finditer(source):
        if match.lastgroup != "skip":
            yield match.lastgroup, match.group(), match.start()


def closing(tokens, opened):
    """Returns the index of the bracket that closes the bracket at `opened`."""
    depth = 0
    for index in range(opened, len(tokens)):
        depth += (tokens[index][1] == "(") - (tokens[index][1] == ")")
        if depth == 0:
            return index
    return opened


def is_quiet(tokens, index):
    text = tokens[index][1]
    return text == "throw" or (text in QUIET_CALLS and tokens[index + 1][1] == "(")


def end_of_quiet(tokens, index):
    """Returns the index of the last token of a template head or of a call that has no effect on results."""
    last = (">",) if tokens[index][1] == "template" else ("(", ";")
    while tokens[index][1] not in last:
        index += 1
    return closing(tokens, index) if tokens[index][1] == "(" else index


def is_plain_default(statement):
    """True if the statement in a class is the default value of a plain member."""
    words = [text for _, text, _ in statement]
    if not words or {"static", "constexpr", "("} & set(words):
        return False
    at = len(words) - words[::-1].index("=") - 1 if "=" in words else len(words)
    return not words[at - 1].endswith("_")


def changes(source, tokens, index):
    """Yields all changes that begin with a token: kind, first and last token, and replacement."""
    kind, text, begin = tokens[index]
    before = tokens[index - 1][1] if index else ""
    after = tokens[index + 1][1] if index + 1 < len(tokens) else ""
    end = begin + len(text)
    if kind == "number" and not text.lower().startswith("0x") and after != ">" and before != "[":
        digits = re.match(r"[\d']+", text).group()
        yield "constant", index, str(int(digits.replace("'", "")) + 1) + text[len(digits):]
    elif kind == "word" and text in WORDS and (text in ("true", "false") or (before == "::" and after == "(")):
        yield "word", index, WORDS[text]
    elif kind == "sign" and text in BINARY and source[begin - 1] == " " and source[end:end + 1] in (" ", "\n"):
        yield "operator", index, BINARY[text]
    elif text in ("++", "--"):
        yield "step", index, "--" if text == "++" else "++"
    elif text == "(" and before in ("if", "while"):
        last = closing(tokens, index)
        inside = source[end:tokens[last][2]]
        if ";" not in inside:
            yield "condition", last, f"(!({inside}))"


def mutants(path, source):
    """Returns all mutants of a file in source order."""
    tokens = list(tokens_of(source))
    scopes = [Scope("file")]
    statement = []
    index = 0
    while index < len(tokens):
        _, text, begin = tokens[index]
        if text == "template" or is_quiet(tokens, index):
            index = end_of_quiet(tokens, index) + 1
            continue
        scope = scopes[-1]
        default = scope.kind == "class" and "=" in [word for _, word, _ in statement] and is_plain_default(statement)
        if not scope.quiet and not default:
            for kind, last, after in changes(source, tokens, index):
                length = tokens[last][2] + len(tokens[last][1]) - begin
                start = source.rfind("\n", 0, begin) + 1
                yield Mutant(path, source.count("\n", 0, begin) + 1, begin - start + 1, kind, begin, length,
                             source[begin:begin + length], after, scope.function)
        if text == "{":
            scopes.append(scope_of(statement, scope))
        if text == "}" and len(scopes) > 1:
            scopes.pop()
        statement = [] if text in (";", "{", "}") else statement + [tokens[index]]
        index += 1
