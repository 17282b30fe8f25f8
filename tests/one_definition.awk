# Fails if two files define a type of one name, outside unnamed namespaces: no compiler tells, and
# the linker joins the members of both. It reads what clang-format has laid out.
#
#   awk -f one_definition.awk FILE...
#
# A file named no_... stands in for others; a .inl file and the part after `#else` of a file of
# kernels lie in the namespace of a vector unit (raster/lanes/for_each_isa.inl).

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
  if (is_unnamed) next
  if (name in defined && defined[name] != FILENAME) {
    print FILENAME ": " name " is defined in " defined[name] ", too"
    wrong = 1
  }
  defined[name] = FILENAME
}

END { exit wrong }
