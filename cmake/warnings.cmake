# What every target of ours is compiled with. -Wrestrict of GCC 12 is wrong about "text" + std::string (its bug 105651).
add_library(chiaro_warnings INTERFACE)
target_compile_options(chiaro_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow=local -Wno-psabi -Wno-missing-field-initializers -Wno-restrict $<$<BOOL:${CHIARO_WERROR}>:-Werror>)
if(CHIARO_SANITIZE)
  add_compile_options(-fsanitize=${CHIARO_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CHIARO_SANITIZE})
endif()
