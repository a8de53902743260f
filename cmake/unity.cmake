# Most of the time of compiling a small file goes into headers: the files of a folder are compiled together, a handful at a
# time. So names in anonymous namespaces must be unique in a folder; CHIARO_UNITY=OFF compiles each file for itself, which
# shows a missing include, and is what to take where one file is edited again and again (preset dev).
option(CHIARO_UNITY "Compile the files of a folder together" ON)

# chiaro_unity(TARGET FILES_PER_UNIT [SOURCE...]): all sources of the target, or those given.
function(chiaro_unity target files_per_unit)
  if(NOT CHIARO_UNITY)
    return()
  endif()
  set(sources ${ARGN})
  if(NOT sources)
    get_target_property(sources ${target} SOURCES)
  endif()
  list(FILTER sources EXCLUDE REGEX "\\$<")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)  # it takes a class of a .cpp file for one of a header
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE path)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    cmake_path(GET path PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    math(EXPR unit "${count_${folder}} + 0")
    math(EXPR count_${folder} "${unit} + 1")
    math(EXPR unit "${unit} / ${files_per_unit}")
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${folder}_${unit})
  endforeach()
endfunction()
