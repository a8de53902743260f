# Most of the time of compiling a small file goes into headers: the files of a folder are compiled together, a handful at a
# time. So names in anonymous namespaces must be unique in a folder; CHIARO_UNITY=OFF compiles each file for itself, which
# shows a missing include, and is what to take where one file is edited again and again (preset dev).
option(CHIARO_UNITY "Compile the files of a folder together" ON)

# chiaro_unity(TARGET FILES_PER_UNIT [SOURCE...]): all sources of the target, or those given, but generated ones and those
# that have options of their own. CMake's own units name files by absolute paths, by which a compiler cache takes each clone
# for another project.
function(chiaro_unity target files_per_unit)
  if(NOT CHIARO_UNITY)
    return()
  endif()
  get_target_property(all ${target} SOURCES)
  set(together ${ARGN})
  if(NOT together)
    set(together ${all})
  endif()
  list(FILTER together EXCLUDE REGEX "\\$<|\\.h$")
  set(units ${CMAKE_CURRENT_BINARY_DIR}/unity/${target})
  foreach(source ${together})
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(generated ${source} GENERATED)  # a unit that names it would not wait for it
    if(definitions OR options OR generated)
      continue()
    endif()
    list(REMOVE_ITEM all ${source})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE OUTPUT_VARIABLE path)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
    cmake_path(GET folder PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    math(EXPR unit "${count_${folder}} + 0")
    math(EXPR count_${folder} "${unit} + 1")
    math(EXPR unit "${unit} / ${files_per_unit}")
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${units})
    list(APPEND names ${folder}_${unit})
    string(APPEND text_${folder}_${unit} "#include \"${path}\"\n")
  endforeach()
  list(REMOVE_DUPLICATES names)
  foreach(name ${names})
    file(CONFIGURE OUTPUT ${units}/${name}.cpp CONTENT "${text_${name}}" @ONLY)
    list(APPEND all ${units}/${name}.cpp)
  endforeach()
  set_target_properties(${target} PROPERTIES SOURCES "${all}")
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)  # it takes a class of a .cpp file for one of a header
endfunction()
