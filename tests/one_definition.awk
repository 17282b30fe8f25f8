# Fails if two files define a type of one name: no compiler tells, and the linker joins the members of
# both. Nor may files that may be compiled together (unit_of()) have types or constants of one name in
# their unnamed namespaces, nor a constant in a function the name of one of those. It reads what
# clang-format has laid out.
#
#   awk -f one_definition.awk FILE...
#
# A file named no_... stands in for others; a .inl file and the part after `#else` of a file of
# kernels lie in the namespace of a vector unit (raster/lanes/for_each_isa.inl).

# As softfocus_folder() and softfocus_part() in CMake files have them.
function unit_of(file) {
  if (file ~ /^tools\/boards\//) return file  # programs
  if (file ~ /^tools\/(gl|crosscheck)\//) return "tools/drivers"
  if (file ~ /^tools\/(files|pictures)\//) return "tools/files"
  if (file ~ /^tools\/(refocus|effects)\//) return "tools/refocus"
  if (match(file, /^(raster\/shaders\/glsl|dof\/(auto|c|fixed|measure)|scenes\/(files|load|models))\//) ||
      match(file, /^tools\/(golden|stress|page)\//)) {
    return substr(file, 1, RLENGTH - 1)
  }
  return substr(file, 1, index(file, "/") - 1)
}

function define(name) {
  if (name in defined && defined[name] != FILENAME) {
    print FILENAME ": " name " is defined in " defined[name] ", too"
    wrong = 1
  }
  defined[name] = FILENAME
}

FNR == 1 {
  depth = 0
  in_unit = FILENAME ~ /[.]inl$/
  has_kernels = 0
}

/^#include "raster\/lanes\/for_each_isa[.]inl"/ { has_kernels = 1 }
/^#else/ && has_kernels { in_unit = 1 }

/^namespace.*[{]/ && !/[}]/ { scope[++depth] = $2 }  # an unnamed one is called {
/^}  \/\/ namespace/ { --depth }

/^(template <.*> )?(struct|class|union|enum) .*[{]/ && FILENAME !~ /\/no_[^\/]*$/ {
  sub(/^template <.*> /, "")
  name = $1 == "enum" && $2 == "class" ? $3 : $2
  sub(/:$/, "", name)
  is_unnamed = 0
  for (i = depth; i > 0; --i) {
    is_unnamed += scope[i] == "{"
    name = scope[i] "::" name
  }
  if (in_unit) name = "a vector unit's " name
  if (is_unnamed) {
    if (in_unit || FILENAME !~ /[.]cpp$/) next
    name = unit_of(FILENAME) "'s " name
  }
  define(name)
}

/^constexpr .* k[A-Z]/ && scope[depth] == "{" && !in_unit && FILENAME ~ /[.]cpp$/ {
  match($0, / k[A-Z][A-Za-z0-9]* ?[={[]/)
  name = substr($0, RSTART + 1)
  sub(/[^A-Za-z0-9].*/, "", name)
  name = unit_of(FILENAME) "'s {::" name
  define(name)
}

/^ +constexpr .* k[A-Z]/ && FILENAME ~ /[.]cpp$/ {
  rest = $0
  while (match(rest, / k[A-Z][A-Za-z0-9]* ?[={[]/)) {
    name = substr(rest, RSTART + 1, RLENGTH - 1)
    rest = substr(rest, RSTART + RLENGTH)
    sub(/[^A-Za-z0-9].*/, "", name)
    inner[unit_of(FILENAME) "'s {::" name, FILENAME ":" FNR] = 1
  }
}

END {
  for (key in inner) {
    split(key, at, SUBSEP)
    if (at[1] in defined && defined[at[1]] != substr(at[2], 1, index(at[2], ":") - 1)) {
      print at[2] ": " at[1] " is defined in " defined[at[1]] ", too"
      wrong = 1
    }
  }
  exit wrong
}
