# What every target of ours is compiled with.
add_library(chiaro_warnings INTERFACE)
target_compile_options(chiaro_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow=local -Wno-psabi $<$<BOOL:${CHIARO_WERROR}>:-Werror>)
if(CHIARO_SANITIZE)
  add_compile_options(-fsanitize=${CHIARO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CHIARO_SANITIZE})
endif()
