# Warnings for our own code only; linked PRIVATE by every target of ours.
add_library(vivify_warnings INTERFACE)
target_compile_options(vivify_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual $<$<BOOL:${VIVIFY_WERROR}>:-Werror>)
# GCC 12 reports these inside the templates of Eigen, CGAL and its own std::string, where nothing is wrong.
target_compile_options(vivify_warnings INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-maybe-uninitialized;-Wno-stringop-overflow;-Wno-stringop-overread>)
