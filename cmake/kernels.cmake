# Kernels are compiled from the launch*.cpp of a folder, once for each instruction set, chosen at start (core/device.cpp).
# These units must hold no inline code of the standard library: the linker keeps one copy of each such function, and it
# might keep the one that an older CPU cannot run.
set(CHIARO_KERNELS native CACHE STRING "Instruction sets that kernels are compiled for: native (scalar and the best of this machine), all, or a list such as scalar;x86_64_v3")
set(CHIARO_ALL_ISAS scalar x86_64_v2 x86_64_v3 x86_64_v4 x86_64_v4_gather) # the last: AVX-512 where gathers are fast

# The best micro-architecture level of the x86-64 psABI that this machine runs, as core/device.cpp finds it.
function(chiaro_native_isa result)
  set(flags "")
  if(EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
    file(STRINGS /proc/cpuinfo vendor REGEX "^vendor_id" LIMIT_COUNT 1)
    string(APPEND flags " ${vendor}")
  endif()
  set(best scalar)
  foreach(level "x86_64_v2 sse4_2 popcnt" "x86_64_v3 avx2 fma bmi1 bmi2" "x86_64_v4 avx512f avx512bw avx512cd avx512dq avx512vl" "x86_64_v4_gather avx512_fp16 GenuineIntel")
    separate_arguments(level)
    list(POP_FRONT level isa)
    foreach(flag ${level})
      if(NOT "${flags} " MATCHES " ${flag} ")
        set(${result} ${best} PARENT_SCOPE)
        return()
      endif()
    endforeach()
    set(best ${isa})
  endforeach()
  set(${result} ${best} PARENT_SCOPE)
endfunction()

if(CHIARO_SANITIZE)
  set(CHIARO_ISAS scalar)  # the same source, and minutes of compiling each
elseif(CHIARO_KERNELS STREQUAL native)
  chiaro_native_isa(CHIARO_ISAS)
elseif(CHIARO_KERNELS STREQUAL all)
  set(CHIARO_ISAS ${CHIARO_ALL_ISAS})
else()
  set(CHIARO_ISAS ${CHIARO_KERNELS})
endif()
foreach(isa ${CHIARO_ISAS})
  if(NOT isa IN_LIST CHIARO_ALL_ISAS)
    message(FATAL_ERROR "CHIARO_KERNELS: '${isa}' is not native, all, or a list of ${CHIARO_ALL_ISAS}")
  endif()
endforeach()
list(PREPEND CHIARO_ISAS scalar)  # always there: the reference, and what an older processor falls back to
list(REMOVE_DUPLICATES CHIARO_ISAS)
message(STATUS "kernels for ${CHIARO_ISAS}")

# What core/isa.h knows of it. Kernels themselves do not see this header: they are not compiled again when the list changes.
set(CHIARO_GENERATED ${PROJECT_BINARY_DIR}/generated)
set(CHIARO_DECLARE_ISAS "")
set(CHIARO_ISA_ALIASES "")
foreach(isa ${CHIARO_ALL_ISAS})
  if(isa IN_LIST CHIARO_ISAS)
    set(CHIARO_HAS_${isa} true)
    string(APPEND CHIARO_DECLARE_ISAS " declare(${isa} __VA_OPT__(, ) __VA_ARGS__)")
  else()
    set(CHIARO_HAS_${isa} false)
    string(APPEND CHIARO_ISA_ALIASES "namespace ${isa} = scalar;\n")
  endif()
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/kernels_built.h.in ${CHIARO_GENERATED}/core/kernels_built.h @ONLY)

set(CHIARO_KERNEL_OPTIMIZATION -O3)
if(CHIARO_SANITIZE)
  set(CHIARO_KERNEL_OPTIMIZATION "") # the preset's own: compiles sooner
endif()
set(CHIARO_FLAGS_scalar -march=x86-64)
set(CHIARO_FLAGS_x86_64_v2 -march=x86-64-v2)
set(CHIARO_FLAGS_x86_64_v3 -march=x86-64-v3)
set(CHIARO_FLAGS_x86_64_v4 -march=x86-64-v4 -mprefer-vector-width=512)
set(CHIARO_FLAGS_x86_64_v4_gather ${CHIARO_FLAGS_x86_64_v4} -DCHIARO_HARDWARE_GATHER)

function(chiaro_add_kernels target)
  file(GLOB_RECURSE launches CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*/launch*.cpp)
  if(NOT launches)
    return()
  endif()
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CHIARO_GENERATED}>)
  foreach(isa ${CHIARO_ISAS})
    set(kernels ${target}_kernels_${isa})
    add_library(${kernels} OBJECT ${launches})
    target_include_directories(${kernels} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_compile_definitions(${kernels} PRIVATE CHIARO_ISA=${isa} CHIARO_ISA_${isa}=1)
    # One rounding rule for all: products and sums are never fused, so every instruction set gives the same bits.
    # A march is one huge block of code: GCC's combiner takes three quarters of the time there (75 s of a unit), half of
    # it for triples and quadruples of instructions that change nothing in what comes out.
    target_compile_options(${kernels} PRIVATE ${CHIARO_FLAGS_${isa}} ${CHIARO_KERNEL_OPTIMIZATION} -ffp-contract=off -fno-math-errno -fno-trapping-math
                           $<$<CXX_COMPILER_ID:GNU>:--param=max-combine-insns=2>
                           -Wno-maybe-uninitialized -Wno-uninitialized) # false alarms inside GCC 12's own AVX-512 header (PR 105593)
    target_link_libraries(${kernels} PRIVATE chiaro_warnings)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${kernels}>)
  endforeach()
endfunction()
