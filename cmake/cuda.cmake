# The kernels for GPUs, from the same source, where nvcc exists. The CUDA runtime becomes part of the library, which so starts
# on machines without CUDA. Where there is no nvcc launch*.cu are not compiled (CHIARO_LAUNCHER in src/cuda/stream.h), and there
# are no GPUs (src/cuda/absent.cpp); the tests' emulation compiles them as C++ (tests/devices.cmake).
option(CHIARO_CUDA "Compile for GPUs where nvcc of CUDA 12 or later is found" ON)
include(CheckLanguage)
if(CHIARO_CUDA AND NOT CHIARO_SANITIZE)
  check_language(CUDA)
endif()
# One portable kind by itself: drivers compile it for their GPU when first run. Releases name the GPUs, which then start at
# once: "75-real;80-real;86-real;89-real;90-real;100-real;120".
set(CHIARO_CUDA_ARCHITECTURES 75-virtual CACHE STRING "Cards that kernels are compiled for, as CMAKE_CUDA_ARCHITECTURES")
if(CHIARO_CUDA AND CMAKE_CUDA_COMPILER)
  set(CMAKE_CUDA_ARCHITECTURES ${CHIARO_CUDA_ARCHITECTURES})
  enable_language(CUDA)
endif()
set(CHIARO_HAS_CUDA FALSE)
if(CHIARO_CUDA AND CMAKE_CUDA_COMPILER AND CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
  find_package(CUDAToolkit REQUIRED)
  set(CHIARO_HAS_CUDA TRUE)
else()
  message(STATUS "no nvcc of CUDA 12 or later: this build has the processor only")
endif()
file(GLOB_RECURSE CHIARO_CUDA_SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*/launch*.cu)
set(CHIARO_CUDA_LAUNCHERS ${CHIARO_CUDA_SOURCES})  # those that the library calls; the others are compiled only
list(FILTER CHIARO_CUDA_LAUNCHERS INCLUDE REGEX "/src/(classify|raycast|pathtrace|image)/|/(spao|cells|histogram|reference|visibility)/|/transport/launch_(gpu|matter)\\.cu$")

# As C++, with the flags that give the same bits as the scalar kernels: for the tests' emulation.
function(chiaro_cuda_as_cpp)
  set_source_files_properties(${CHIARO_CUDA_LAUNCHERS} PROPERTIES LANGUAGE CXX COMPILE_OPTIONS
                              "-x;c++;${CHIARO_FLAGS_scalar};-ffp-contract=off;-fno-math-errno;-fno-trapping-math;-Wno-unknown-pragmas;-Wno-maybe-uninitialized;-O1")
endfunction()

function(chiaro_add_cuda target)
  if(NOT CHIARO_HAS_CUDA)
    target_sources(${target} PRIVATE src/cuda/absent.cpp)
    target_compile_definitions(${target} PRIVATE CHIARO_WITHOUT_CUDA)
    return()
  endif()
  add_library(chiaro_cuda_kernels OBJECT ${CHIARO_CUDA_SOURCES})
  target_include_directories(chiaro_cuda_kernels PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include)
  # CMake 3.25 does not know C++20 for nvcc 13; -fmad=false keeps products and sums apart as on the CPU.
  set_target_properties(chiaro_cuda_kernels PROPERTIES CUDA_STANDARD_REQUIRED OFF CUDA_SEPARABLE_COMPILATION OFF)
  target_compile_options(chiaro_cuda_kernels PRIVATE -std=c++20 -fmad=false --expt-relaxed-constexpr -Werror all-warnings)
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.8)
    target_compile_options(chiaro_cuda_kernels PRIVATE --compress-mode=size)  # two thirds of the size
  endif()
  target_sources(${target} PRIVATE src/cuda/stream.cpp $<TARGET_OBJECTS:chiaro_cuda_kernels>)
  target_include_directories(${target} SYSTEM PRIVATE ${CUDAToolkit_INCLUDE_DIRS})
  target_link_libraries(${target} PRIVATE CUDA::cudart_static)
endfunction()
