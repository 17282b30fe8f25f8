# Copies a header for users, whose includes of ours lie below softfocus/:
#   cmake -D FROM=FILE -D TO=FILE -P public_header.cmake
file(READ ${FROM} text)
string(REGEX REPLACE "#include \"(raster|dof|scenes)/" "#include \"softfocus/\\1/" text "${text}")
file(WRITE ${TO} "${text}")
