# vivify_precompile(NAME HEADERS... LIBRARIES...): headers that many files include, compiled once; others take them with
# target_precompile_headers(OTHER REUSE_FROM NAME). A target of its own, as its users must define all that it defines; it
# needs a source file, which is empty.
function(vivify_precompile name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES" ${ARGN})
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} vivify_warnings)
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

vivify_precompile(vivify_precompiled
  HEADERS <Eigen/Dense> <Eigen/Sparse> <filesystem> <functional> <map> <string>
  LIBRARIES Eigen3::Eigen)
