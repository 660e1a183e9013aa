# Headers that most files include, compiled once: target_precompile_headers(NAME REUSE_FROM vivify_precompiled). A
# target of its own, as its users must define all that it defines; it needs a source file, which is empty.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
add_library(vivify_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
target_link_libraries(vivify_precompiled PRIVATE Eigen3::Eigen vivify_warnings)
target_precompile_headers(vivify_precompiled PRIVATE <Eigen/Dense> <Eigen/Sparse> <filesystem> <functional> <map> <string>)
