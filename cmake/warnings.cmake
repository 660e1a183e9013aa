# Warnings for our own code only; linked PRIVATE by every target of ours.
add_library(vivify_warnings INTERFACE)
target_compile_options(vivify_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual $<$<BOOL:${VIVIFY_WERROR}>:-Werror>)
