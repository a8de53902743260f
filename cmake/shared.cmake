# libchiaro.so from the objects of the static libraries, which compile once. It is no part of the tool, which needs what is
# hidden here, and so is not built for the tool.
add_library(chiaro_shared SHARED ${PROJECT_SOURCE_DIR}/cmake/shared.map)
add_library(chiaro::chiaro ALIAS chiaro_shared)
add_library(chiaro::static ALIAS chiaro)
# Until 1.0 a minor version may change what programs are compiled against.
set_target_properties(chiaro_shared PROPERTIES OUTPUT_NAME chiaro EXPORT_NAME chiaro LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/shared.map)
set_target_properties(chiaro PROPERTIES EXPORT_NAME static)
target_include_directories(chiaro_shared INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(chiaro_shared INTERFACE cxx_std_20)
# Whole, with the viewer's server (chiaro/view.h), so that nothing of the interface is missing; then once more for what they need.
target_link_libraries(chiaro_shared PRIVATE -Wl,--whole-archive $<BUILD_INTERFACE:$<TARGET_FILE:chiaro>> $<BUILD_INTERFACE:$<TARGET_FILE:chiaro_server>>
                      -Wl,--no-whole-archive $<BUILD_INTERFACE:chiaro_server>)
target_link_options(chiaro_shared PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/shared.map -Wl,--exclude-libs,libcudart_static.a
                    -Wl,--no-undefined -Wl,--as-needed)
