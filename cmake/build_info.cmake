# Writes the header build_info.h: version, libraries, and a hash of the sources of each module with all that lies below
# it. Run with cmake -P at build time, so that a changed source always changes the keys of the stage cache.
# In: SOURCE_DIR, OUTPUT, VERSION, COMPILER (identification and flags), LIBRARIES ("name=version" separated by |).

function(hash_sources result)
  set(text "${COMPILER} ${LIBRARIES}")
  foreach(prefix ${ARGN})
    file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${prefix}*.h ${SOURCE_DIR}/${prefix}*.cpp)
    list(SORT files)
    foreach(file ${files})
      file(SHA256 ${SOURCE_DIR}/${file} hash)
      string(APPEND text "\n${file} ${hash}")
    endforeach()
  endforeach()
  string(SHA256 hash "${text}")
  string(SUBSTRING ${hash} 0 32 hash)
  set(${result} ${hash} PARENT_SCOPE)
endfunction()

hash_sources(meshing common/ meshing/ pipeline/stages/ pipeline/placement pipeline/body_ pipeline/example_ pipeline/pose_file)
hash_sources(sim common/ sim/ pipeline/stages/ pipeline/placement)
hash_sources(render common/ render/ pipeline/stages/ pipeline/placement pipeline/looks pipeline/camera_path pipeline/video)

set(libraries "")
string(REPLACE "|" ";" entries "${LIBRARIES}")
foreach(entry ${entries})
  string(REGEX MATCH "^([^=]*)=(.*)$" matched "${entry}")
  string(APPEND libraries "    {\"${CMAKE_MATCH_1}\", \"${CMAKE_MATCH_2}\"},\n")
endforeach()

set(text "// Made by cmake/build_info.cmake.
#pragma once

namespace vivify::pipeline {

struct NamedText {
  const char* name;
  const char* text;
};
inline constexpr const char* kProgramVersion = \"${VERSION}\";
inline constexpr NamedText kSourceRevisions[] = {
    {\"meshing\", \"${meshing}\"},
    {\"sim\", \"${sim}\"},
    {\"render\", \"${render}\"},
};
inline constexpr NamedText kLibraryVersions[] = {
${libraries}};

}  // namespace vivify::pipeline
")
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${text}" @ONLY)
