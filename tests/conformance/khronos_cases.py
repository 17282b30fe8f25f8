"""Reads the `.test` files of Khronos' VK-GL-CTS (framework/opengl/gluShaderLibrary.cpp there), and
makes of each case the shaders that a driver would be given (modules/glshared)."""

import dataclasses
import os
import re

SHAPES = {
    "float": (1, 1), "int": (1, 1), "uint": (1, 1), "bool": (1, 1),
    **{f"{kind}vec{n}": (1, n) for kind in ("", "i", "u", "b") for n in (2, 3, 4)},
    **{f"mat{n}": (n, n) for n in (2, 3, 4)},
    **{f"mat{c}x{r}": (c, r) for c in (2, 3, 4) for r in (2, 3, 4) if c != r},
}
STAGES = ("vertex", "fragment", "geometry", "tessellation_control", "tessellation_evaluation")
TOKEN = re.compile(
    r'(?:\s|#[^\r\n]*)*(?:(?P<source>""(?:\\.|[^\\])*?"")|(?P<string>"(?:\\.|[^"\\])*"|'
    r"'(?:\\.|[^'\\])*')|(?P<number>\d+(?:\.\d*(?:[eE][+-]?\d+)?)?)|"
    r"(?P<word>[A-Za-z][A-Za-z0-9_.-]*)|(?P<sign>[=+\-,|;()\[\]{}>])|(?P<end>$))", re.S)


@dataclasses.dataclass
class Value:
    type: str
    name: str
    elements: list  # of each, its numbers

    @property
    def numbers(self):
        columns, rows = SHAPES[self.type]
        return columns * rows

    @property
    def is_float(self):
        return self.type[0] in "fvm"

    @property
    def float_type(self):
        return self.type if self.is_float else f"vec{self.numbers}" if self.numbers > 1 else "float"


@dataclasses.dataclass
class Case:
    path: str
    kind: str = "complete"  # or vertex, fragment: of a source for both
    version: str = "100 es"
    expect: str = "pass"
    sources: dict = dataclasses.field(default_factory=dict)  # lists, by stage
    values: dict = dataclasses.field(
        default_factory=lambda: {"input": [], "output": [], "uniform": []})
    extensions: list = dataclasses.field(default_factory=list)
    requirements: list = dataclasses.field(default_factory=list)
    has_pipelines: bool = False
    output_format: str = "vec4"


def unescaped(text):
    return re.sub(r"\\(.)", lambda m: {"n": "\n", "t": "\t"}.get(m[1], m[1]), text, flags=re.S)


def source_text(token):
    """Without the first empty line and the first line's indentation."""
    text = unescaped(re.sub(r"\A *\r?\n?", "", token[2:-2]))
    indentation = sum(4 if c == "\t" else 1 for c in text[: len(text) - len(text.lstrip())])
    lines = []
    for line in text.replace("\r\n", "\n").split("\n"):
        left = indentation
        while left > 0 and line[:1] in (" ", "\t"):
            left -= 4 if line[0] == "\t" else 1
            line = line[1:]
        lines.append(line)
    return "\n".join(lines)


class Reader:
    def __init__(self, file):
        with open(file, encoding="utf-8", errors="surrogateescape") as opened:
            self.text = opened.read()
        self.file, self.at = file, 0
        self.advance()

    def advance(self):
        token = getattr(self, "token", None)
        found = TOKEN.match(self.text, self.at)
        if not found:
            raise ValueError(f"{self.file}: near {self.text[self.at:self.at + 60]!r}")
        self.at = found.end()
        self.kind, self.token = found.lastgroup, found[found.lastgroup]
        return token

    def take(self, token):
        if self.token != token:
            raise ValueError(f"{self.file}: {self.token!r}, not {token!r}, near "
                             f"{self.text[self.at:self.at + 60]!r}")
        self.advance()

    def string(self):
        return unescaped(self.advance()[1:-1])

    def cases(self, path, end=None):
        found = []
        while self.token != end and self.kind != "end":
            if self.token == "case":
                found += self.case(path)
            elif self.token == "group":
                self.advance()
                name = self.advance()
                self.string()
                found += self.cases(path + [name], "end")
                self.take("end")
            else:
                self.take("import")
                found += read_cases(os.path.join(os.path.dirname(self.file), self.string()), path)
        return found

    def case(self, path):
        self.take("case")
        case, both = Case("/".join(path + [self.advance()])), None
        while self.token != "end":
            key = self.advance()
            if key == "desc":
                self.string()
            elif key == "expect":
                case.expect = self.advance()
            elif key == "output_color":
                case.output_format = self.advance()
            elif key == "values":
                self.value_block(case.values)
            elif key == "both":
                both = source_text(self.advance())
            elif key in STAGES:
                case.sources.setdefault(key, []).append(source_text(self.advance()))
            elif key == "version":
                case.version = self.advance()
                if self.token in ("es", "core", "compatibility"):
                    case.version += " " + self.advance()
            elif key == "require":
                self.requirement(case)
            elif key == "pipeline_program":
                case.has_pipelines = True
                while self.token != "end":
                    self.advance()
                self.take("end")
            else:
                raise ValueError(f"{self.file}: {key!r} in a case")
        self.take("end")
        if both is None:
            return [case]
        return [dataclasses.replace(case, path=f"{case.path}_{stage}", kind=stage,
                                    sources={stage: [both]}) for stage in ("vertex", "fragment")]

    def requirement(self, case):
        what = self.advance()
        if what == "extension":
            self.take("{")
            names = [self.string()]
            while self.token == "|":
                self.advance()
                names.append(self.string())
            self.take("}")
            stages = STAGES
            if self.token == "in":
                self.advance()
                self.take("{")
                stages = [self.advance()]
                while self.token == ",":
                    self.advance()
                    stages.append(self.advance())
                self.take("}")
            case.extensions.append((names, stages))
        elif what == "limit":
            case.requirements.append(f"limit {self.string()}")
            self.take(">")
            self.advance()
        else:
            case.requirements.append(what)

    def value_block(self, values):
        self.take("{")
        while self.token != "}":
            storage, kind = self.advance(), self.advance()
            name = self.string() if self.kind == "string" else self.advance()
            value = Value(kind, name, [])
            self.take("=")
            if self.token == "[":
                self.advance()
                value.elements.append(self.element(value))
                while self.token == "|":
                    self.advance()
                    value.elements.append(self.element(value))
                self.take("]")
            else:
                value.elements.append(self.element(value))
            self.take(";")
            values[storage].append(value)
        self.take("}")

    def element(self, value):
        if value.numbers > 1:
            self.take(value.type)
            self.take("(")
        numbers = []
        for i in range(value.numbers):
            if i > 0:
                self.take(",")
            sign = 1
            if self.token == "-":
                sign = -1
                self.advance()
            token = self.advance()
            if token in ("true", "false"):
                numbers.append(float(token == "true"))
            elif value.is_float:
                numbers.append(sign * float(token))
            else:  # of 32 bits, whatever it says
                number = sign * int(token) & 0xFFFFFFFF
                is_negative = value.type[0] != "u" and number >= 1 << 31
                numbers.append(float(number - (1 << 32) if is_negative else number))
        if value.numbers > 1:
            self.take(")")
        return numbers


def read_cases(file, path):
    return Reader(file).cases(path)


# --- the shaders of a case ---

EPSILON = "0.05"  # what the suite compares floats with


def uses_in_out(case):
    return case.version != "100 es"


def compare_functions(case, by_floats):
    text = ""
    for kind in {value.type: None for value in case.values["output"]}:
        columns, rows = SHAPES[kind]
        if columns > 1:
            differences = [f"abs(a[{i}] - b[{i}])" for i in range(columns)]
            largest = differences[0]
            for difference in differences[1:]:
                largest = f"max({largest}, {difference})"
            text += (f"bool isOk({kind} a, {kind} b, float eps) {{ return all(lessThanEqual("
                     f"{largest}, vec{rows}(eps))); }}\n")
        elif kind[0] in "fv":
            test = "abs(a - b) <= eps * abs(b) + eps"
            if rows > 1:
                test = "all(lessThanEqual(abs(a - b), eps * abs(b) + eps))"
            text += f"bool isOk({kind} a, {kind} b, float eps) {{ return {test}; }}\n"
        elif not by_floats:
            text += f"bool isOk({kind} a, {kind} b) {{ return a == b; }}\n"
        else:
            given = "float" if rows == 1 else f"vec{rows}"
            if kind[0] == "b":
                test = "(a > 0.5) == b" if rows == 1 else f"greaterThan(a, {given}(0.5)) == b"
            elif rows > 1:
                test = f"{kind}(floor(a + 0.5)) == b"
            else:
                one = "1u" if kind[0] == "u" else "1"
                test = f"float(b) <= a + 0.5 && a + 0.5 <= float(b + {one})"
            text += f"bool isOk({given} a, {kind} b) {{ return {test}; }}\n"
    return text


def compare_text(case, color, prefix=""):
    outputs = case.values["output"]
    if not outputs:
        return f"{color} = vec4(1.0);\n"
    text = ""
    for value in outputs:
        call = (f"isOk({value.name}, ref_{value.name}, {EPSILON})" if value.is_float
                else f"isOk({prefix}{value.name}, ref_{value.name})")
        text += f"RES = RES && {call};\n" if text else f"bool RES = {call};\n"
    return text + f"{color} = vec4(RES, RES, RES, 1.0);\n"


def specialized(case, stage, source, parameters):
    text = re.sub(r"\$\{(\w+)(:[\w-]+)?\}", lambda m: single_line(parameters[m[1]], m[2]), source)
    wanted = "".join(f"#extension {names[0]} : require\n"
                     for names, stages in case.extensions if stage in stages)
    if not wanted:
        return text
    lines = text.splitlines(keepends=True)
    first = next((i for i, line in enumerate(lines) if not line.lstrip("\t ").startswith("#")),
                 len(lines))
    return "".join(lines[:first]) + wanted + "".join(lines[first:])


def single_line(text, option):
    return text.replace("\n", " ") if option == ":single-line" else text


def input_lines(case, qualifier):
    """Declarations of the inputs, and what makes whole numbers of those that come as floats."""
    declared = setup = ""
    for value in case.values["input"]:
        if value.is_float:
            declared += f"{qualifier} {value.type} {value.name};\n"
        else:
            declared += f"{qualifier} {value.float_type} a_{value.name};\n"
            setup += f"{value.type} {value.name} = {value.type}(a_{value.name});\n"
    return declared, setup


def uniform_lines(case):
    return "".join(f"uniform {value.type} {value.name};\n" for value in case.values["uniform"]
                   if "." not in value.name)


def reference_lines(case):
    return "".join(f"uniform {value.type} ref_{value.name};\n{value.type} {value.name};\n"
                   for value in case.values["output"])


def head(case, precision="highp"):
    return (f"#version {case.version.replace('100 es', '100')}\n"
            f"precision {precision} float;\nprecision {precision} int;\n")


def shaders_of(case):
    """The texts of the vertex and the fragment shader. Throws KeyError for a parameter that the
    suite does not know."""
    color = "dEQP_FragColor" if uses_in_out(case) else "gl_FragColor"
    color_line = ("layout(location = 0) out mediump vec4 dEQP_FragColor;\n" if uses_in_out(case)
                  else "")
    given, made, taken = (("in", "out", "in") if uses_in_out(case)
                          else ("attribute", "varying", "varying"))
    position = f"{given} highp vec4 dEQP_Position;\n"
    if case.kind == "vertex":
        declared, setup = input_lines(case, given)
        declared, output = position + declared, "gl_Position = dEQP_Position;\n"
        fragment = head(case, "highp" if uses_in_out(case) else "mediump") + color_line
        fragment += compare_functions(case, True)
        for value in case.values["output"]:
            if value.is_float:
                declared += f"{made} {value.type} {value.name};\n"
                fragment += f"{taken} {value.type} {value.name};\n"
            else:
                declared += f"{made} {value.float_type} v_{value.name};\n"
                declared += f"{value.type} {value.name};\n"
                output += f"v_{value.name} = {value.float_type}({value.name});\n"
                fragment += f"{taken} {value.float_type} v_{value.name};\n"
            fragment += f"uniform {value.type} ref_{value.name};\n"
        fragment += "void main()\n{\n" + compare_text(case, color, "v_") + "}\n"
        vertex = specialized(case, "vertex", case.sources["vertex"][0], {
            "DECLARATIONS": declared, "SETUP": setup, "OUTPUT": output,
            "POSITION_FRAG_COLOR": "gl_Position"})
        return vertex, fragment
    if case.kind == "fragment":
        vertex, main = head(case) + position, "gl_Position = dEQP_Position;\n"
        declared, setup = compare_functions(case, False) + color_line, ""
        for value in case.values["input"]:
            name = value.name if value.is_float else f"v_{value.name}"
            vertex += f"{given} {value.float_type} a_{value.name};\n"
            vertex += f"{made} {value.float_type} {name};\n"
            main += f"{name} = a_{value.name};\n"
            declared += f"{taken} {value.float_type} {name};\n"
            if not value.is_float:
                nudge = " * 1.0025" if value.type[0] == "i" else ""
                setup += f"{value.type} {value.name} = {value.type}({name}{nudge});\n"
        declared += reference_lines(case)
        fragment = specialized(case, "fragment", case.sources["fragment"][0], {
            "DECLARATIONS": declared, "SETUP": setup, "OUTPUT": compare_text(case, color),
            "POSITION_FRAG_COLOR": color})
        return vertex + "void main()\n{\n" + main + "}\n", fragment
    declared, setup = input_lines(case, given)
    vertex = specialized(case, "vertex", case.sources["vertex"][0], {
        "VERTEX_DECLARATIONS": position + declared + uniform_lines(case), "VERTEX_SETUP": setup,
        "VERTEX_OUTPUT": "gl_Position = dEQP_Position;\n"})
    fragment = specialized(case, "fragment", case.sources["fragment"][0], {
        "FRAGMENT_DECLARATIONS": (compare_functions(case, False) + color_line +
                                  reference_lines(case) + uniform_lines(case)),
        "FRAGMENT_OUTPUT": compare_text(case, color), "FRAG_COLOR": color})
    return vertex, fragment
