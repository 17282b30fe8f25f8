#!/usr/bin/env python3
"""piglit's shader_test files on the emulated GPU: a vertex and a fragment shader draw rectangles, and
pixels are probed.

    piglit.py CHECKOUT [FOLDER...] [--only TEXT]

CHECKOUT is a copy of piglit, FOLDER one below its tests/spec; without one glsl-1.10 to glsl-1.50,
glsl-es-1.00 and glsl-es-3.00. --only runs the cases whose path has a text. The library is the file
that SOFTFOCUS_LIBRARY names, or that of a build in this checkout. The exit status is 1 if a case
fails that is not in KNOWN.
"""

import ctypes
import glob
import os
import re
import struct
import sys

import emulator

FOLDERS = ("glsl-1.10", "glsl-1.20", "glsl-1.30", "glsl-1.40", "glsl-1.50", "glsl-es-1.00",
           "glsl-es-3.00")
SIDE = 250  # of the window
TOLERANCE = 0.01
IDENTITY = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
# OpenGL's state where a test sets nothing.
BUILT_INS = {"gl_LightSource[].ambient": (0, 0, 0, 1), "gl_LightSource[].constantAttenuation": (1,),
             "gl_DepthRange.near": (0,), "gl_DepthRange.far": (1,), "gl_DepthRange.diff": (1,)}
PASS_THROUGH = ("#if __VERSION__ >= 130\nin vec4 piglit_vertex;\n#else\n"
                "attribute vec4 piglit_vertex;\n#endif\n"
                "void main() { gl_Position = piglit_vertex; }\n")

DENORMALS = "denormals are kept; the case expects 0 for 2^-149"
CONSTANTS = "the compiler folds constants in its own way"

# Parts of the paths of cases that fail, and why.
KNOWN = {
    "fs-underflow-": DENORMALS,
    "const-builtin-degrees": CONSTANTS,
    "glsl-const-folding-01": CONSTANTS,
    "-inline-explosion": "2^64 calls; functions are inlined, 64 deep",
    "vs-out-conversion-int-to-float-vec4-index": "the compiler takes an out parameter's index "
                                                 "after the call",
}


class NotApplicable(Exception):
    """A case needs what the emulation does not have; the text says what."""


class Wrong(Exception):
    """A probe found another value."""


def sections_of(file):
    """Pairs of a section's name and its text."""
    sections = []
    with open(file, encoding="utf-8", errors="surrogateescape") as opened:
        for line in opened:
            if line.startswith("["):
                sections.append([line.strip()[1:-1].strip(), ""])
            elif sections:
                sections[-1][1] += line
    return sections


def version_line(required, text):
    """What stands before a text without a version: that which the case requires."""
    found = re.search(r"^\s*GLSL(\s+ES)?\s*>=\s*(\d)\.(\d\d)", required, re.M)
    if not found or "#version " in text:
        return ""
    number = found[2] + found[3]
    return f"#version {number}" + (" es\n" if found[1] and number != "100" else "\n")


def codes_of(colour):
    return bytes(min(max(int(c * 255 + 0.5), 0), 255) for c in colour)


class Window:
    """What the commands of a test change."""

    def __init__(self, gpu, program, sources, data):
        self.gpu, self.program, self.data = gpu, program, data
        self.all_text = "\n".join(sources)
        self.clear_color, self.tolerance = (0, 0, 0, 0), [TOLERANCE] * 4
        self.projection = IDENTITY
        self.color = (1, 1, 1, 1)
        self.coordinates = {}
        self.textures, self.units, self.samplers = {}, {}, {}
        self.depth_mode = "luminance"
        self.clear()

    def clear(self):
        self.picture = emulator.Picture(SIDE, SIDE, "rgba8", codes_of(self.clear_color))

    # --- state ---

    def set_uniform(self, words):
        kind, name, *texts = words
        read = float_of if kind[0] in "fvm" else number_of
        numbers = [read(text.rstrip(",;")) for text in texts]
        if found := re.fullmatch(r"[iu]?vec(\d)", kind):  # what is left out is 0
            numbers = (numbers + [0.0] * 4)[:int(found[1])]
        if kind.startswith("d") or "64" in kind:
            raise NotApplicable("numbers of 64 bits")
        found = next((shader for shader in self.program.shaders if shader.has(name)), None)
        if found is None:
            # OpenGL names a block's members by the block, the emulation by its instance.
            block, _, member = name.partition(".")
            instance = re.search(rf"\buniform\s+{re.escape(block)}\s*\{{[^}}]*\}}\s*(\w+)",
                                 self.all_text)
            if member and instance and self.program.set(f"{instance[1]}.{member}", numbers):
                return
            if self.is_texture(name):
                self.units[name] = int(numbers[0])
                return
            raise Wrong(f"there is no uniform {name}")
        if self.is_texture(name):
            self.units[name] = int(numbers[0])
            return
        self.program.set(name, numbers)

    def is_texture(self, name):
        base = re.escape(re.sub(r"\[\d+\]$", "", name).rpartition(".")[2])
        return re.search(rf"\b[iu]?sampler\w+\b[^;()]*\b{base}\b", self.all_text) is not None

    def bind_textures(self):
        for shader in self.program.shaders:
            for name in shader.uniforms:
                if not self.is_texture(name):
                    continue
                unit = self.units.get(name, self.units.get(name.removesuffix("[0]"), 0))
                if unit in self.textures:
                    shader.set_texture(name, *self.textures[unit], self.samplers.get(unit, {}))

    def set_built_ins(self):
        for shader in self.program.shaders:
            for name in shader.uniforms:
                if not name.startswith("gl_"):
                    continue
                base = name.partition("[")[0]
                if base in ("gl_ModelViewProjectionMatrix", "gl_ProjectionMatrix"):
                    shader.set(base, self.projection)
                elif name in BUILT_INS or re.sub(r"\[\d+\]", "[]", name) in BUILT_INS:
                    shader.set(name, BUILT_INS[re.sub(r"\[\d+\]", "[]", name)])
                elif base == "gl_ModelViewMatrix":
                    shader.set(base, IDENTITY)
                elif base == "gl_NormalMatrix":
                    shader.set(base, (1, 0, 0, 0, 1, 0, 0, 0, 1))

    # --- drawing ---

    def draw(self, attributes, count, indices):
        if self.depth_mode != "intensity" and re.search(r"\bshadow[12]D", self.all_text):
            raise NotApplicable("depth texture modes other than intensity")
        self.set_built_ins()
        self.bind_textures()
        self.program.draw(attributes, count, indices, [self.picture])

    def draw_rectangle(self, x, y, width, height, texture=None):
        corners = [(x, y), (x + width, y), (x, y + height), (x + width, y + height)]
        positions = [c for corner in corners for c in (*corner, 0, 1)]
        attributes = {"piglit_vertex": positions, "gl_Vertex": positions,
                      "gl_Color": self.color * 4, "gl_Normal": (0, 0, 1) * 4}
        inputs = re.findall(r"\b(?:in|attribute)\s+vec4\s+(\w+)", self.program.vertex_text)
        if not re.search(r"\b(piglit_vertex|gl_Vertex|ftransform)\b", self.program.vertex_text):
            attributes.update({name: positions for name in inputs[:1]})  # the first has location 0
        if texture:
            tx, ty, tw, th = texture
            places = [(tx, ty), (tx + tw, ty), (tx, ty + th), (tx + tw, ty + th)]
            attributes["piglit_texcoord"] = [c for place in places for c in (*place, 0, 1)]
            attributes["gl_MultiTexCoord0"] = attributes["piglit_texcoord"]
        for unit, place in self.coordinates.items():
            attributes.setdefault(f"gl_MultiTexCoord{unit}", place * 4)
        self.draw(attributes, 4, (0, 1, 2, 2, 1, 3))

    def draw_arrays(self, mode, first, count):
        lines = [line.partition("#")[0].split() for line in self.data.splitlines()]
        lines = [line for line in lines if line]
        if not lines:
            raise NotApplicable("draws without vertex data")
        attributes, at = {"gl_Color": self.color * (len(lines) - 1)}, 0
        for column in lines[0]:
            name, kind, shape, *matrix = column.split("/")
            if kind not in ("float", "int", "uint") or matrix:
                raise NotApplicable(f"vertex data of {kind}" + (" matrices" if matrix else ""))
            numbers = int(re.search(r"\d*$", shape)[0] or 1)
            texts = [t for line in lines[1:] for t in line[at:at + numbers]]
            if kind != "float" and not shape.startswith(("vec", "float")):
                words = [int(t, 0) & 0xFFFFFFFF for t in texts]
                attributes[name] = (ctypes.c_uint32 * len(words))(*words)
            else:
                attributes[name] = [float_of(t) for t in texts]
            at += numbers
        vertices = range(first, first + count)
        if mode == "GL_TRIANGLES":
            indices = list(vertices)
        elif mode == "GL_TRIANGLE_FAN" or mode == "GL_QUADS" and count == 4:
            indices = [v for i in range(1, count - 1) for v in (first, first + i, first + i + 1)]
        elif mode == "GL_TRIANGLE_STRIP":
            indices = [v for i in range(count - 2)
                       for v in ((first + i, first + i + 1, first + i + 2) if i % 2 == 0
                                 else (first + i + 1, first + i, first + i + 2))]
        else:
            raise NotApplicable(f"draws {mode}")
        self.draw(attributes, len(lines) - 1, indices)

    # --- probes ---

    def probe(self, x, y, width, height, expected):
        words = memoryview(self.picture.memory)[:4 * SIDE * SIDE].cast("B").cast("I")
        checked = {}
        for row in range(y, y + height):
            for column in range(x, x + width):
                word = words[row * SIDE + column]
                if word in checked:
                    continue
                found = [c / 255 for c in struct.pack("I", word)]
                if any(abs(f - e) > t for f, e, t in zip(found, expected, self.tolerance)):
                    raise Wrong(f"pixel {column}, {row} is {tuple(round(f, 3) for f in found)}, "
                                f"not {tuple(expected)}")
                checked[word] = True

    # --- textures ---

    def rgbw(self, unit, width, height):
        data = b""
        for y in range(height):
            for x in range(width):
                data += ((b"\xff\0\0\xff", b"\0\xff\0\xff"), (b"\0\0\xff\xff", b"\xff" * 4))[
                    y >= height // 2][x >= width // 2]
        self.textures[unit] = (width, height, "rgba8", data)

    def depths(self, unit, width, height):
        row = struct.pack(f"{width}f", *[x / max(width - 1, 1) for x in range(width)])
        self.textures[unit] = (width, height, "r32f", row * height)
        self.samplers[unit] = {"compare": "greater"}

    def set_sampler(self, parameter, value):
        """Of the unit whose texture was made last."""
        unit = list(self.textures)[-1]
        sampler = self.samplers.setdefault(unit, {})
        key = {"min": "filter", "mag": "filter", "wrap_s": "wrap_u", "wrap_t": "wrap_v",
               "compare_func": "compare"}.get(parameter)
        value = {"linear": "bilinear", "clamp_to_edge": "clamp"}.get(value, value)
        known = {"filter": emulator.FILTERS, "compare": emulator.COMPARES}.get(key, emulator.WRAPS)
        if key is None or value not in known:
            raise NotApplicable(f"texture parameter {parameter} {value}")
        sampler[key] = value

    def checkerboard(self, unit, width, height, black, white):
        data = b"".join(
            codes_of(white if (x // max(width // 2, 1) ^ y // max(height // 2, 1)) & 1 else black)
            for y in range(height) for x in range(width))
        self.textures[unit] = (width, height, "rgba8", data)


def number_of(text):
    try:
        return float(int(text, 0))
    except ValueError:
        return float(text)


def float_of(text):
    """Hexadecimal digits are a float's bits."""
    if text.lower().startswith("0x"):
        return struct.unpack("f", struct.pack("I", int(text, 16)))[0]
    return number_of(text)


def numbers_in(text):
    return [number_of(t) for t in re.findall(r"-?0x[0-9a-fA-F]+|[-+]?(?:\d+\.?\d*|\.\d+)"
                                              r"(?:[eE][-+]?\d+)?|-?inf|nan", text)]


def run_command(window, line):
    words = line.split()
    n = numbers_in(re.sub(r"\b(GL_\w+|[123]D|shadow\w+)", "", line))
    if line.startswith("uniform "):
        window.set_uniform(words[1:])
    elif line.startswith("clear color"):
        window.clear_color = n
    elif line.startswith("clear depth"):
        pass
    elif line == "clear":
        window.clear()
    elif line.startswith("draw rect ortho patch") or line.startswith("draw rect patch"):
        raise NotApplicable("tessellation")
    elif line.startswith("draw rect ortho"):
        window.draw_rectangle(*[2 * c / SIDE - (1 if i < 2 else 0) for i, c in enumerate(n[:4])])
    elif line.startswith("draw rect tex"):
        window.draw_rectangle(*n[:4], texture=n[4:8])
    elif line.startswith("draw rect"):
        window.draw_rectangle(*n[:4])
    elif line.startswith("draw arrays instanced") or line.startswith("draw instanced"):
        raise NotApplicable("instances")
    elif line.startswith("draw arrays"):
        window.draw_arrays(words[2], int(words[3]), int(words[4]))
    elif line.startswith("ortho"):
        left, right, bottom, top = n if n else (0, SIDE, 0, SIDE)
        window.projection = (2 / (right - left), 0, 0, 0, 0, 2 / (top - bottom), 0, 0, 0, 0, -1, 0,
                             -(right + left) / (right - left), -(top + bottom) / (top - bottom), 0,
                             1)
    elif line.startswith("color "):
        window.color = tuple(n)
    elif line.startswith("texcoord"):
        window.coordinates[int(n[0])] = tuple(n[1:5])
    elif line.startswith("tolerance"):
        window.tolerance = n
    elif line.startswith("probe all") or line.startswith("probe warn all"):
        window.probe(0, 0, SIDE, SIDE, n if "rgba" in line else n[:3])
    elif line.startswith("probe rect"):
        window.probe(*[int(c) for c in n[:4]], n[4:])
    elif line.startswith("probe rgb"):
        window.probe(int(n[0]), int(n[1]), 1, 1, n[2:6 if line.startswith("probe rgba") else 5])
    elif line.startswith("relative probe rect rgba int"):
        raise NotApplicable("integer framebuffers")
    elif line.startswith("relative probe rect"):
        window.probe(*[int(c * SIDE) for c in n[:4]], n[4:])
    elif line.startswith("relative probe rgb"):
        window.probe(min(int(n[0] * SIDE), SIDE - 1), min(int(n[1] * SIDE), SIDE - 1), 1, 1,
                     n[2:6 if "rgba" in line else 5])
    elif line.startswith("texture rgbw") and words[2].isdigit():
        if len(words) > 8 or re.search(r"GL_(?!RGBA\b|RGBA8\b)\w+", line):
            raise NotApplicable("textures of other formats")
        window.rgbw(int(n[0]), int(n[1]), int(n[2]))
    elif line.startswith("texture checkerboard"):
        if int(n[1]) != 0:
            raise NotApplicable("levels of a texture one by one")
        window.checkerboard(int(n[0]), int(n[2]), int(n[3]), n[4:8], n[8:12])
    elif line.startswith(("texture shadow2D ", "texture shadow1D ", "texture shadowRect ")):
        window.depths(*[int(c) for c in n[:3]], *([1] if len(n) == 2 else []))
    elif line.startswith("texparameter ") and words[2] == "depth_mode":
        window.depth_mode = words[3]
    elif line.startswith("texparameter "):
        window.set_sampler(words[2], words[3])
    elif line.startswith(("hint ", "link success")):
        pass
    else:
        raise NotApplicable(words[0] if words[0] not in ("enable", "texture", "texparameter", "probe")
                            else " ".join(words[:2]))


def run_case(gpu, case):
    """("passed", ""), ("failed", why) or ("not applicable", why)."""
    path, sections = case
    named = {}
    for name, text in sections:
        named.setdefault(name, []).append(text)
    for name in named:
        if name.endswith("spirv") or name.startswith(("geometry", "tessellation", "compute")):
            return "not applicable", name.replace(" layout", " shader")
        if name.endswith("program"):
            return "not applicable", "assembly programs"
    if len(named.get("vertex shader", [])) > 1 or len(named.get("fragment shader", [])) > 1:
        return "not applicable", "several sources of a stage"
    commands = [line.partition("#")[0].strip() for line in named.get("test", [""])[0].splitlines()]
    commands = [line for line in commands if line]
    wants_error = any(line.startswith("link error") for line in commands)
    required = named["require"][0] if "require" in named else ""
    if "SIZE" in required or "INT " in required:
        return "not applicable", "limits of an implementation"
    if "fragment shader" not in named or not (
            "vertex shader" in named or "vertex shader passthrough" in named):
        return "not applicable", "no vertex or no fragment shader"
    fragment = named["fragment shader"][0]
    vertex = named.get("vertex shader", [PASS_THROUGH])[0]
    if "vertex shader passthrough" in named:
        vertex = "".join(re.findall(r"^\s*#\s*version.*\n", fragment, re.M)) + PASS_THROUGH
    sources = [version_line(required, text) + text for text in (vertex, fragment)]
    try:
        program = emulator.Program(gpu, *sources)
        program.link()
    except emulator.ShaderRefused as error:
        return ("passed", "") if wants_error else ("failed", f"does not compile: {error}")
    except emulator.NotSupported as error:
        return "not applicable", str(error)
    except RuntimeError as error:
        return "failed", str(error)
    if wants_error:
        return "failed", "links; an error would be right"
    try:
        window = Window(gpu, program, sources, named.get("vertex data", [""])[0])
        for line in commands:
            run_command(window, line)
    except NotApplicable as error:
        return "not applicable", str(error)
    except (Wrong, emulator.ShaderRefused, emulator.NotSupported, RuntimeError) as error:
        return "failed", f"{line}: {error}"
    return "passed", ""


def cases_of(checkout, folder):
    root = os.path.join(checkout, "tests", "spec", folder)
    files = sorted(glob.glob(os.path.join(root, "**", "*.shader_test"), recursive=True))
    if not files:
        sys.exit(f"{root} has no .shader_test files")
    for file in files:
        path = f"{folder}/{os.path.relpath(file, root).removesuffix('.shader_test')}"
        yield folder, path, (path, sections_of(file))


if __name__ == "__main__":
    emulator.run_suite(__doc__, FOLDERS, KNOWN, run_case, cases_of)
