#!/bin/bash
# The commands of docs/building.md and docs/embedding.md in several orders, in a copy of the tree:
# each finds build/ as the ones before have left it. And tools/test, of tests that do not run.
# Nothing is compiled: every object file is that of a program which does what $work/program does.
# Nothing is installed: apt-get is one that says what it was asked for.
#
#   tests/tools/commands_test.sh

set -uo pipefail
export LC_ALL=C
required=${SOFTFOCUS_REQUIRE-}
unset CXX CC CXXFLAGS SOFTFOCUS_REQUIRE SOFTFOCUS_SECONDS
cd -P "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
work=$(mktemp -d /tmp/softfocus-commands-test-XXXXXX) || exit 1
trap 'rm -rf "$work"' EXIT
failed=0

fail() {
  echo "failed: $*"
  tail -n 20 "$work/said"
  failed=1
}

# stub NAME: a script from standard input, where commands are looked for first.
stub() { cat >"$work/bin/$1" && chmod +x "$work/bin/$1"; }

make_stubs() {
  mkdir "$work/bin"
  stub program <<'END'
#!/bin/sh
case ${PROGRAM##*/}-${1-} in
  softfocus-documentation)
    mkdir -p "$2/man/man1" "$2/bash-completion" "$2/zsh" "$2/fish" && touch "$2/man/man1/softfocus.1"
    ;;
  softfocus-render) touch "$4" ;;
  softfocus_tests-*) echo "[doctest] test cases:  ${CASES:-999} |  ${CASES:-999} passed | 0 failed |" ;;
esac
END
  cat >"$work/program.cpp" <<END
#include <cstdlib>
#include <unistd.h>
__attribute__((weak)) int main(int, char** argv) {
  setenv("PROGRAM", argv[0], 1);
  return execv("$work/bin/program", argv);
}
END
  c++ -fPIC -c "$work/program.cpp" -o "$work/program.o" || exit 1
  # CMake's own tries are compiled.
  stub compile <<END
#!/bin/sh
case \$PWD in */CMakeFiles/CMake*) exec "\$@" ;; esac
while [ "\$1" != -o ]; do shift; done
sleep \${SLOW:-0}
exec cp "$work/program.o" "\$2"
END
  export CMAKE_CXX_COMPILER_LAUNCHER=$work/bin/compile CMAKE_C_COMPILER_LAUNCHER=$work/bin/compile
  echo 'echo installed' | stub dpkg-query
  echo "echo \"\$*\" >>$work/asked" | stub apt-get
  # shellcheck disable=SC2016
  echo 'exec "$@"' | stub sudo
  export PATH=$work/bin:$PATH
}

copy_tree() {
  mkdir "$work/tree" &&
    cp -a ./*.md LICENSE CMakeLists.txt CMakePresets.json raster dof scenes tools tests docs "$work/tree" &&
    cd "$work/tree" || exit 1
  # These run what is compiled, or this.
  sed -i '1i return()' tests/embedding.cmake tests/walls.cmake
  printf '#!/bin/sh\n' | tee tests/tools/{farm_test.sh,blender_test.py} >tests/tools/commands_test.sh
}

# run COMMAND...: must succeed.
run() { "$@" >"$work/said" 2>&1 </dev/null || fail "$* (after:$before)"; }

# documented COMMAND: likewise, and stands in a page.
documented() {
  grep -qF -- "$1" docs/building.md docs/embedding.md || fail "no page has: $1"
  # shellcheck disable=SC2086  # words without blanks
  run ${1/ PREFIX/ $work/prefix}
}

# says TEXT: the last command did.
says() { grep -q -- "$1" "$work/said" || fail "it does not say '$1' (after:$before)"; }

there() { [ -e "$1" ] || fail "$1 is not there (after:$before)"; }
not_there() { [ ! -e "$1" ] || fail "$1 is there (after:$before)"; }

demo() {
  rm -rf out
  documented tools/demo
  there out/sphere-world.png
}

all_tests() {
  documented tools/test
  says ' passed, 0 failed, 0 skipped$'
}

by_hand() {
  documented 'cmake --preset release'
  documented 'cmake --build build'
  documented 'ctest --test-dir build --output-on-failure'
  says '100% tests passed'
}

installed() {
  export DESTDIR=$work/root
  documented 'cmake --install build --prefix /usr/local'
  unset DESTDIR
  for file in bin/softfocus lib/libsoftfocus.so share/man/man1/softfocus.1 include/softfocus/scenes.h; do
    there "$work/root/usr/local/$file"
  done
  rm -rf "$work/root"
}

libraries() {
  documented 'cmake -S . -B build-libraries -G Ninja -DSOFTFOCUS_TOOLS=OFF'
  documented 'cmake --build build-libraries'
  documented 'cmake --install build-libraries --prefix PREFIX'
  there "$work/prefix/include/softfocus/dof.h"
  not_there "$work/prefix/include/softfocus/scenes.h"
  rm -rf "$work/prefix"
}

# In the folder of all the others.
libraries_alone() {
  run cmake -S . -B build -G Ninja -DSOFTFOCUS_TOOLS=OFF
  run cmake --build build
  run cmake --install build --prefix "$work/prefix"
  not_there "$work/prefix/include/softfocus/scenes.h"
  ctest --test-dir build --no-tests=error >"$work/said" 2>&1 && fail "there are tests of another time"
  rm -rf "$work/prefix"
}

packages() {
  if ! command -v file >/dev/null || ! command -v dpkg-shlibdeps >/dev/null; then
    echo "skipped: Debian packages (apt-get install dpkg-dev file)"
    [ "$required" != all ] || failed=1
    return
  fi
  documented 'cmake -S . -B build-debian -G Ninja -DCMAKE_INSTALL_PREFIX=/usr -DSOFTFOCUS_TESTS=OFF'
  documented 'cmake --build build-debian'
  documented 'cpack -G DEB --config build-debian/CPackConfig.cmake'
  there libsoftfocus-dev_*.deb
}

# in_order STEP...: in a new build/.
in_order() {
  rm -rf build
  before=
  for step in "$@"; do
    "$step"
    before+=" $step"
  done
}

# refused TEXT...: tools/test fails, and says these.
refused() {
  tools/test >"$work/said" 2>&1 </dev/null && fail "tools/test passes"
  for text in "$@"; do says "$text"; done
}

# ctest_is LINE...: of a script.
ctest_is() { printf '%s\n' "$@" | stub ctest; }

counting() {
  local ctest
  ctest=$(command -v ctest)
  before=' counting'
  ctest_is 'rm build/softfocus_tests' "exec $ctest \"\$@\""
  refused 'failed: raster/numbers/half_test.cpp, which did not run' '^[1-9] passed, [0-9][0-9][0-9] failed, 0 skipped$'
  ctest_is "exec $ctest \"\$@\" -E numbers.half_test"
  refused 'failed: raster/numbers/half_test.cpp, which is not among the tests' ', 1 failed, 0 skipped$'
  ctest_is "$ctest \"\$@\"" 'exit 7'
  refused 'failed: ctest, though no test did' ', 1 failed, 0 skipped$'
  ctest_is 'exit 0'
  refused '^0 passed, [0-9][0-9][0-9] failed, 0 skipped$'
  rm "$work/bin/ctest"
  CASES=1 refused 'failed: dof/lens_test.cpp: 1 of its '
}

# What tools/demo installs, and a build without the rest.
bare_machine() {
  before=' bare_machine'
  echo 'exit 1' | stub dpkg-query
  rm -f "$work/asked"
  run tools/demo
  cp "$work/asked" "$work/said"
  says 'install .*g++ cmake ninja-build'
  grep -qE 'doctest|epoxy|embree|mesa|openexr|numpy' "$work/asked" && fail "tools/demo asks for more"
  run tools/test
  cp "$work/asked" "$work/said"
  says 'install .*doctest-dev'
  run cmake -S . -B build-bare -G Ninja -DCMAKE_DISABLE_FIND_PACKAGE_doctest=ON
  says 'doctest-dev.*-DSOFTFOCUS_TESTS=OFF'
  ctest --test-dir build-bare >"$work/said" 2>&1 && fail "no tests, and ctest passes"
  run cmake -S . -B build-bare -G Ninja -DCMAKE_DISABLE_FIND_PACKAGE_doctest=OFF
  run ctest --test-dir build-bare -N
  says half_test
  # As a build without glslang leaves it, once glslang is there.
  grep -q 'GLSLANG_INCLUDE_DIR.*NOTFOUND' build-bare/CMakeCache.txt && return
  run cmake -S . -B build-bare -G Ninja -DGLSLANG_WORKS:INTERNAL=
  grep -q 'GLSLANG_WORKS.*=1' build-bare/CMakeCache.txt || fail "glslang is not looked for again"
}

progress() {
  before=' progress'
  rm -rf build out
  SLOW=.05 run script -qec tools/demo /dev/null
  says 'building build/softfocus ... \[[0-9]*/[0-9]*\]'
}

make_stubs
copy_tree
in_order demo installed libraries_alone demo installed all_tests libraries_alone by_hand installed demo
in_order libraries_alone all_tests installed by_hand libraries all_tests packages
counting
bare_machine
progress
exit $failed
