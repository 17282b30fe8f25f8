# Debian packages, by `cpack -G DEB` in the build folder: the program, the shared library, and what
# programs are built with. Configure with -DCMAKE_INSTALL_PREFIX=/usr, so that libraries go where
# Debian has them. tools/package makes them in bare roots and tries them there.
set(with_components "")
if(SOFTFOCUS_TOOLS)
  list(APPEND with_components softfocus)
endif()
if(softfocus_shared)
  list(APPEND with_components libsoftfocus)
endif()
list(APPEND with_components libsoftfocus-dev)
set(CPACK_COMPONENTS_ALL ${with_components})

if(DEFINED ENV{DEBEMAIL})  # as of Debian's own tools
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  set(CPACK_PACKAGE_CONTACT "the softfocus authors <root@localhost>")
endif()
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own
set(version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

# debian_package(COMPONENT NAME SECTION SYNOPSIS LINE...): the lines describe it.
function(debian_package component name section synopsis)
  string(TOUPPER ${component} upper)
  list(JOIN ARGN "\n" lines)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${synopsis}\n${lines}" PARENT_SCOPE)
  set(folder ${CMAKE_INSTALL_DATAROOTDIR}/doc/${name})
  install(FILES ${PROJECT_BINARY_DIR}/debian/copyright ${PROJECT_BINARY_DIR}/debian/changelog.Debian.gz
          DESTINATION ${folder} COMPONENT ${component})
endfunction()

# Where Debian's Python looks, of no other prefix.
if(softfocus_shared AND CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  install(DIRECTORY tools/python/softfocus DESTINATION lib/python3/dist-packages
          COMPONENT libsoftfocus-dev PATTERN __pycache__ EXCLUDE)
endif()

debian_package(softfocus softfocus graphics "depth of field for pictures and scenes"
  "Gives a picture with depth the depth of field of a lens, by any of the"
  "published methods, and draws scenes through the same lens by a software GPU."
  "The same input gives the same bits on every machine.")
set(CPACK_DEBIAN_SOFTFOCUS_PACKAGE_SUGGESTS "ffmpeg")
debian_package(libsoftfocus libsoftfocus${PROJECT_VERSION_MAJOR} libs
  "depth of field for pictures - shared library"
  "Gives a picture with depth the depth of field of a lens, from C or what calls"
  "C. The same input gives the same bits on every machine.")
debian_package(libsoftfocus-dev libsoftfocus-dev libdevel
  "depth of field for pictures - development files"
  "Headers for the C interface, and headers and static libraries for C++: depth of"
  "field, the software GPU under it, and measures of pictures.")
set(CPACK_DEBIAN_LIBSOFTFOCUS-DEV_PACKAGE_DEPENDS
    "libsoftfocus${PROJECT_VERSION_MAJOR} (= ${version}), libglm-dev")
set(CPACK_DEBIAN_LIBSOFTFOCUS-DEV_PACKAGE_SUGGESTS "glslang-dev, libembree-dev, pkgconf")

file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBSOFTFOCUS_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)

# Our licence, and those of the headers that are compiled in.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE copyright)
string(APPEND copyright "\nParts of these libraries are compiled into softfocus:\n")
foreach(library libglm-dev libtinyobjloader-dev libstb-dev libtomlplusplus-dev libcli11-dev
        nlohmann-json3-dev libtinygltf-dev)
  if(EXISTS /usr/share/doc/${library}/copyright)
    file(READ /usr/share/doc/${library}/copyright text)
    string(APPEND copyright "\n--- ${library} ---\n\n${text}")
  endif()
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/debian/copyright "${copyright}")

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # or SOURCE_DATE_EPOCH
file(WRITE ${PROJECT_BINARY_DIR}/debian/changelog.Debian
"softfocus (${version}) unstable; urgency=medium

  * ${PROJECT_VERSION}: /usr/share/doc/softfocus/CHANGELOG.md has the changes.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
file(ARCHIVE_CREATE OUTPUT ${PROJECT_BINARY_DIR}/debian/changelog.Debian.gz
     PATHS ${PROJECT_BINARY_DIR}/debian/changelog.Debian FORMAT raw COMPRESSION GZip
     COMPRESSION_LEVEL 9)
include(CPack)
