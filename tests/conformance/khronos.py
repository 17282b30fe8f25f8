#!/usr/bin/env python3
"""Khronos' VK-GL-CTS on the emulated GPU: the cases of its shader library, whose shaders compare
what they compute with right values.

    khronos.py CHECKOUT [FOLDER...] [--only TEXT]

CHECKOUT is a copy of github.com/KhronosGroup/VK-GL-CTS, FOLDER one of it with `.test` files; without
one data/gles3/shaders, data/gles2/shaders and external/openglcts/data/gl_cts/data/gl33. --only runs
the cases whose path has a text. The library is the file that SOFTFOCUS_LIBRARY names, or that of a
build in this checkout. The exit status is 1 if a case fails that is not in KNOWN.
"""

import glob
import os
import sys

import emulator
import khronos_cases

FOLDERS = ("data/gles3/shaders", "data/gles2/shaders",
           "external/openglcts/data/gl_cts/data/gl33")
SIDE = 16
POSITIONS = (-1, -1, 0, 1, -1, 1, 0, 1, 1, -1, 0, 1, 1, 1, 0, 1)
INDICES = (0, 1, 2, 1, 3, 2)

LOW = "lowp and mediump are one"

# Parts of the paths of cases that fail, and why.
KNOWN = {
    "basic/precision_conflict_4": LOW,
    "struct/precision_conflict_": LOW,
    "struct_precision_conflict_": LOW,
    "layout_qualifier_mismatch": "a block's layout means nothing: it is set member by member",
    "predefined_macros/file_": "__FILE__ is not 0: the compiler gives the text's number",
    "conditional_inclusion/define_defined": "the compiler refuses a macro of the name defined",
    "reserved_keywords/sample_": "a name, as browsers have it; public shaders use it so",
    "gl33/preprocessor/basic/stringification": "the compiler takes # in a macro",
}


def not_applicable(case):
    stages = [stage for stage in case.sources if stage not in ("vertex", "fragment")]
    if stages:
        return f"{stages[0].replace('_', ' ')} shaders"
    if case.has_pipelines:
        return "separate programs"
    if any(len(sources) > 1 for sources in case.sources.values()):
        return "several sources of a stage"
    if case.requirements and case.requirements[0].startswith(("only_", "exactly_", "limit")):
        return case.requirements[0].split(" ")[0].replace("_", " ")
    return None


def run_case(gpu, case):
    """("passed", ""), ("failed", why) or ("not applicable", why)."""
    if why := not_applicable(case):
        return "not applicable", why
    try:
        vertex, fragment = khronos_cases.shaders_of(case)
        program = emulator.Program(gpu, vertex, fragment)
    except emulator.ShaderRefused as error:
        if case.expect in ("compile_fail", "compile_or_link_fail"):
            return "passed", ""
        return "failed", f"does not compile: {error}"
    except emulator.NotSupported as error:
        return "not applicable", str(error)
    except RuntimeError as error:
        return "failed", str(error)
    try:
        program.link()
    except emulator.ShaderRefused as error:
        if case.expect in ("link_fail", "compile_or_link_fail"):
            return "passed", ""
        return "failed", f"does not link: {error}"
    if case.expect.endswith("_fail"):
        return "failed", f"is accepted; {case.expect} would be right"
    if case.expect == "build_successful":
        return "passed", ""
    try:
        return drawn(program, case)
    except (emulator.ShaderRefused, emulator.NotSupported, RuntimeError) as error:
        return "failed", f"does not run: {error}"


def drawn(program, case):
    outputs = case.values["output"]
    for i in range(len(outputs[0].elements) if outputs else 1):
        attributes = {"dEQP_Position": POSITIONS}
        for value in case.values["input"]:
            prefix = "a_" if case.kind == "fragment" or not value.is_float else ""
            attributes[prefix + value.name] = value.elements[i] * 4
        for value in outputs:
            program.set("ref_" + value.name, value.elements[i])
        for value in case.values["uniform"]:
            program.set(value.name, value.elements[i])
        picture = emulator.Picture(SIDE, SIDE, "rgba8", (32, 64, 128, 255))
        program.draw(attributes, 4, INDICES, [picture])
        for y in range(SIDE):
            for x in range(SIDE):
                found = picture.pixel(x, y)
                if found[:3] != (1, 1, 1):
                    return "failed", f"values {i + 1}: pixel {x}, {y} is {found}"
    return "passed", ""


def cases_of(checkout, folder):
    suite = os.path.basename(folder.removesuffix("/shaders"))
    files = sorted(glob.glob(os.path.join(checkout, folder, "*.test")))
    if not files:
        sys.exit(f"{checkout}/{folder} has no .test files")
    for file in files:
        group = f"{suite}/{os.path.basename(file).removesuffix('.test')}"
        for case in khronos_cases.read_cases(file, [group]):
            yield group, case.path, case


if __name__ == "__main__":
    emulator.run_suite(__doc__, FOLDERS, KNOWN, run_case, cases_of)
