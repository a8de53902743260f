# Kernels are compiled from the launch*.cpp of a folder, once for each instruction set, chosen at start (core/device.cpp).
# These units must hold no inline code of the standard library: the linker keeps one copy of each such function, and it
# might keep the one that an older CPU cannot run.
set(CHIARO_ISAS scalar x86_64_v2 x86_64_v3 x86_64_v4)
option(CHIARO_SCALAR_KERNELS "Compile kernels for one pixel at a time only: slow, but soon built" OFF)
set(CHIARO_KERNEL_OPTIMIZATION -O3)
if(CHIARO_SANITIZE OR CHIARO_SCALAR_KERNELS)
  set(CHIARO_ISAS scalar) # core/isa.h lets it stand for all
endif()
if(CHIARO_SANITIZE)
  set(CHIARO_KERNEL_OPTIMIZATION "") # the preset's own: compiles sooner
endif()
set(CHIARO_FLAGS_scalar -march=x86-64)
set(CHIARO_FLAGS_x86_64_v2 -march=x86-64-v2)
set(CHIARO_FLAGS_x86_64_v3 -march=x86-64-v3)
set(CHIARO_FLAGS_x86_64_v4 -march=x86-64-v4 -mprefer-vector-width=512)

function(chiaro_add_kernels target)
  file(GLOB_RECURSE launches CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*/launch*.cpp)
  if(NOT launches)
    return()
  endif()
  if(CHIARO_ISAS STREQUAL scalar)
    target_compile_definitions(${target} PUBLIC CHIARO_SCALAR_ONLY)
  endif()
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
