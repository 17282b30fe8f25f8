"""The emulated GPU by the C interface of libsoftfocus, and workers that run cases on it: a case that
crashes or hangs costs its worker and nothing else."""

import argparse
import ctypes
import glob
import multiprocessing
import os
import re
import struct
import sys

OK, BAD_ARGUMENT, NO_MEMORY, FAILED, BAD_SHADER = range(5)
STAGES = {"fragment": 1, "vertex": 2}
FORMATS = {"r8": 1, "rgba8": 2, "srgb8": 3, "rgba16f": 4, "r32f": 5, "rgba32f": 6, "rgba32i": 7,
           "rgba32ui": 8}
FILTERS = {"nearest": 1, "bilinear": 2, "trilinear": 3}
WRAPS = {"repeat": 1, "mirror": 2, "clamp": 3}
COMPARES = {name: i + 1 for i, name in enumerate(
    ("never", "less", "equal", "lequal", "greater", "notequal", "gequal", "always"))}
SECONDS = 60  # that a case may take

# Words of the emulation's errors. All else is the text's fault.
NOT_SUPPORTED = re.compile(r"[\w ]+ (is|are) not supported(?=; [^:]*$|$)")  # what it does not have
TOO_MUCH = re.compile(r"is too long|too deeply|damaged|not structured|have too many numbers")


class ShaderRefused(Exception):
    """A shader's text is at fault."""


class NotSupported(Exception):
    """The emulation says that it does not have something."""


class Texels(ctypes.Structure):
    """softfocus_texels."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("width", ctypes.c_int32),
                ("height", ctypes.c_int32), ("format", ctypes.c_int32),
                ("first", ctypes.c_void_p), ("row_bytes", ctypes.c_ssize_t),
                ("slices", ctypes.c_int32), ("slice_bytes", ctypes.c_ssize_t)]


class Pass(ctypes.Structure):
    """softfocus_pass."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("targets", ctypes.c_void_p),
                ("target_count", ctypes.c_int32), ("profile", ctypes.c_char_p),
                ("budget", ctypes.c_uint64)]


class Source(ctypes.Structure):
    """softfocus_shader_source."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("stage", ctypes.c_int32),
                ("text", ctypes.c_char_p), ("words", ctypes.c_void_p),
                ("word_count", ctypes.c_size_t), ("name", ctypes.c_char_p),
                ("convention", ctypes.c_char_p)]


class Sampler(ctypes.Structure):
    """softfocus_sampler."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("filter", ctypes.c_int32),
                ("wrap_u", ctypes.c_int32), ("wrap_v", ctypes.c_int32),
                ("compare", ctypes.c_int32), ("wrap_w", ctypes.c_int32)]


class Attribute(ctypes.Structure):
    """softfocus_attribute."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("name", ctypes.c_char_p),
                ("first", ctypes.c_void_p), ("vertex_bytes", ctypes.c_size_t),
                ("numbers", ctypes.c_int32)]


class Vertices(ctypes.Structure):
    """softfocus_vertices."""

    _fields_ = [("struct_size", ctypes.c_size_t), ("attributes", ctypes.c_void_p),
                ("attribute_count", ctypes.c_int32), ("vertex_count", ctypes.c_int32),
                ("indices", ctypes.c_void_p), ("index_count", ctypes.c_size_t)]


def sized(kind, **fields):
    return kind(struct_size=ctypes.sizeof(kind), **fields)


def pointers(structs):
    array = (ctypes.c_void_p * max(len(structs), 1))()
    for i, one in enumerate(structs):
        array[i] = ctypes.addressof(one) if one is not None else None
    return array


class Emulator:
    def __init__(self, library):
        self.library = ctypes.CDLL(library)
        self.library.softfocus_message.restype = ctypes.c_char_p
        self.library.softfocus_uniform_name.restype = ctypes.c_char_p
        self.context = ctypes.c_void_p()
        self.call("open", ctypes.byref(self.context), 1)

    def call(self, name, *arguments):
        status = getattr(self.library, "softfocus_" + name)(*arguments)
        if status == OK:
            return
        message = self.library.softfocus_message(self.context).decode(errors="replace")
        if status != BAD_SHADER:
            raise RuntimeError(f"softfocus_{name}: {message or status}")
        if found := NOT_SUPPORTED.search(message):
            raise NotSupported(found[0].strip())
        if TOO_MUCH.search(message):
            raise RuntimeError(message)
        raise ShaderRefused(message)


class Shader:
    def __init__(self, emulator, stage, text):
        self.emulator, self.handle = emulator, ctypes.c_void_p()
        source = sized(Source, stage=STAGES[stage], text=text.encode(errors="surrogateescape"),
                       name=stage.encode(), convention=b"plain")
        emulator.call("compile_shader", emulator.context, ctypes.byref(source),
                      ctypes.byref(self.handle))
        self.uniforms = []
        while name := emulator.library.softfocus_uniform_name(self.handle,
                                                              ctypes.c_size_t(len(self.uniforms))):
            self.uniforms.append(name.decode())

    def __del__(self):
        self.emulator.library.softfocus_free_shader(self.handle)

    def has(self, name):
        return name in self.uniforms or re.sub(r"\[\d+\]$", "", name) in self.uniforms

    def set(self, name, numbers):
        array = (ctypes.c_double * len(numbers))(*numbers)
        self.emulator.call("set_uniform", self.emulator.context, self.handle, name.encode(), array,
                           ctypes.c_size_t(len(numbers)))

    def set_texture(self, name, width, height, texel_format, data, sampling, slices=1):
        """`sampling`: "filter", "wrap_u", "wrap_v", "wrap_w" and "compare" by name; all may be left
        out. `slices`: layers, slices or faces, one behind the other."""
        memory = ctypes.create_string_buffer(data, len(data))
        texels = sized(Texels, width=width, height=height, format=FORMATS[texel_format],
                       first=ctypes.addressof(memory), slices=slices)
        sampler = sized(Sampler, filter=FILTERS[sampling.get("filter", "nearest")],
                        wrap_u=WRAPS[sampling.get("wrap_u", "clamp")],
                        wrap_v=WRAPS[sampling.get("wrap_v", "clamp")],
                        wrap_w=WRAPS[sampling.get("wrap_w", "clamp")],
                        compare=COMPARES[sampling.get("compare", "lequal")])
        self.emulator.call("set_texture", self.emulator.context, self.handle, name.encode(),
                           ctypes.byref(texels), ctypes.byref(sampler))


class Picture:
    """A target, cleared with four numbers."""

    TYPES = {"rgba8": "4B", "rgba32f": "4f", "rgba32i": "4i", "rgba32ui": "4I"}

    def __init__(self, width, height, texel_format, cleared):
        self.width, self.height, self.format = width, height, texel_format
        self.memory = ctypes.create_string_buffer(
            struct.pack(self.TYPES[texel_format], *cleared) * (width * height))
        self.texels = sized(Texels, width=width, height=height, format=FORMATS[texel_format],
                            first=ctypes.addressof(self.memory))

    def pixel(self, x, y):
        layout = self.TYPES[self.format]
        at = (y * self.width + x) * struct.calcsize(layout)
        values = struct.unpack_from(layout, self.memory, at)
        return tuple(v / 255 for v in values) if self.format == "rgba8" else values


class Program:
    """A vertex and a fragment shader, linked. Raises ShaderRefused and NotSupported."""

    def __init__(self, emulator, vertex, fragment):
        self.emulator, self.vertex_text = emulator, vertex
        self.shaders = [Shader(emulator, "vertex", vertex), Shader(emulator, "fragment", fragment)]

    def link(self):
        self.emulator.call("link_shaders", self.emulator.context, *[s.handle for s in self.shaders])

    def set(self, name, numbers):
        found = [shader for shader in self.shaders if shader.has(name)]
        for shader in found:
            shader.set(name, numbers)
        return bool(found)

    def draw(self, attributes, vertex_count, indices, pictures):
        """`attributes`: by name, each vertex's numbers one after the other; floats, if they are
        no array of ctypes. Those that the vertex shader does not name are left out."""
        attributes = {name: numbers for name, numbers in attributes.items()
                      if re.search(rf"\b{re.escape(name)}\b", self.vertex_text) or
                      name == "gl_Vertex" and "ftransform" in self.vertex_text}
        memories = [numbers if isinstance(numbers, ctypes.Array)
                    else (ctypes.c_float * len(numbers))(*numbers)
                    for numbers in attributes.values()]
        structs = [sized(Attribute, name=name.encode(), first=ctypes.addressof(memory),
                         vertex_bytes=4 * (len(memory) // vertex_count),
                         numbers=len(memory) // vertex_count)
                   for name, memory in zip(attributes, memories)]
        numbers = (ctypes.c_uint32 * len(indices))(*indices)
        all_attributes, targets = pointers(structs), pointers([p and p.texels for p in pictures])
        vertices = sized(Vertices, attributes=ctypes.addressof(all_attributes),
                         attribute_count=len(structs), vertex_count=vertex_count,
                         indices=ctypes.addressof(numbers), index_count=len(indices))
        where = sized(Pass, targets=ctypes.addressof(targets), target_count=len(pictures))
        self.emulator.call("draw_shaders", self.emulator.context,
                           *[shader.handle for shader in self.shaders], ctypes.byref(vertices),
                           ctypes.byref(where))


# --- workers ---


def serve(library, run_case, pipe):
    emulator = Emulator(library)
    while True:
        pipe.send(run_case(emulator, pipe.recv()))


class Worker:
    def __init__(self, library, run_case):
        self.arguments = (library, run_case)
        self.process = None

    def start(self):
        self.pipe, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=serve, args=(*self.arguments, theirs),
                                               daemon=True)
        self.process.start()
        theirs.close()

    def run(self, case):
        if self.process is None:
            self.start()
        self.pipe.send(case)
        try:
            if self.pipe.poll(SECONDS):
                return self.pipe.recv()
            why = f"takes longer than {SECONDS} s"
        except EOFError:
            self.process.join()
            why = f"ends the program with status {self.process.exitcode}"
        self.process.kill()
        self.process = None
        return "failed", why


def find_library():
    named = os.environ.get("SOFTFOCUS_LIBRARY")
    if named:
        return named
    checkout = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    built = glob.glob(os.path.join(checkout, "build*", "**", "libsoftfocus.so.*"), recursive=True)
    return min(built, key=len) if built else "libsoftfocus.so.0"


# --- results ---


class Results:
    """By group: how many passed and failed, and what was not applicable, by its reason."""

    def __init__(self, known):
        self.groups, self.failures, self.known = {}, [], known

    def add(self, group, path, outcome, reason):
        counts = self.groups.setdefault(group, {"passed": 0, "failed": 0, "reasons": {}})
        if outcome == "not applicable":
            counts["reasons"][reason] = counts["reasons"].get(reason, 0) + 1
        else:
            counts[outcome] += 1
        if outcome == "failed":
            self.failures.append((path, reason))

    def reason(self, path):
        return next((reason for part, reason in self.known.items() if part in path), None)

    def tell(self):
        """Prints all; whether each failure is a known one."""
        rows = [("", "cases", "applicable", "passed", "failed")]
        total, reasons = [0, 0, 0, 0], {}
        for group, counts in self.groups.items():
            applicable = counts["passed"] + counts["failed"]
            left_out = sum(counts["reasons"].values())
            row = [applicable + left_out, applicable, counts["passed"], counts["failed"]]
            rows.append((group, *row))
            total = [a + b for a, b in zip(total, row)]
            for reason, count in counts["reasons"].items():
                reasons[reason] = reasons.get(reason, 0) + count
        rows.append(("all", *total))
        for path, reason in self.failures:
            known = self.reason(path)
            print(f"failed: {path}: {reason}" + (f" (known: {known})" if known else ""))
        for name, *counts in rows:
            print(f"{name:<44}" + "".join(f"{count:>12}" for count in counts))
        for reason, count in sorted(reasons.items(), key=lambda item: -item[1]):
            print(f"not applicable: {count} {reason}")
        if total[1]:
            print(f"{100 * total[2] / total[1]:.2f} % of the applicable cases pass")
        return all(self.reason(path) for path, _ in self.failures)


def run_suite(about, folders, known, run_case, cases_of):
    """The runner's command line. `cases_of`: of a checkout and a folder, each case's group and
    path, and what `run_case` takes."""
    parser = argparse.ArgumentParser(description=about,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout")
    parser.add_argument("folder", nargs="*")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    worker = Worker(find_library(), run_case)
    results = Results(known)
    for folder in options.folder or folders:
        for group, path, case in cases_of(options.checkout, folder):
            if options.only in path:
                results.add(group, path, *worker.run(case))
    sys.exit(0 if results.tell() else 1)
