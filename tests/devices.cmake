# What is true of the CPU is true of a GPU: the same tests there (cuda/NAME, "skipped" without one), and on the
# emulated GPU (emulated/NAME). CHIARO_DEVICE_TESTS: programs that ask devices.h where to work.
if(CHIARO_SANITIZE)  # these watch the CPU: a GPU has a sanitizer of its own, and the other would be minutes of compiling
  return()
endif()
foreach(name ${CHIARO_DEVICE_TESTS})
  add_test(NAME cuda/${name} COMMAND ${name})
  set_tests_properties(cuda/${name} PROPERTIES LABELS cuda TIMEOUT ${CHIARO_TEST_TIMEOUT} SKIP_RETURN_CODE 77 ENVIRONMENT CHIARO_TEST_DEVICE=cuda)
endforeach()
# All of them, and those of the GPU itself, in one program, which is small enough to be carried to a GPU (scripts/gpu).
list(TRANSFORM CHIARO_DEVICE_TESTS REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
foreach(name cuda_test cuda_light_test cuda_histogram_test cuda_frame_test cuda_texture_test)
  list(APPEND objects $<TARGET_OBJECTS:${name}>)
endforeach()
add_executable(gpu_tests EXCLUDE_FROM_ALL ${objects})
target_link_libraries(gpu_tests PRIVATE places chiaro_bench chiaro GTest::gtest_main fmt::fmt nlohmann_json::nlohmann_json ZLIB::ZLIB OpenEXR::OpenEXR chiaro_warnings)

# That GPU is the same units, compiled for the CPU. It watches its memory itself.
add_library(cuda_emulated OBJECT ${CHIARO_CUDA_LAUNCHERS} ${PROJECT_SOURCE_DIR}/src/cuda/stream.cpp cuda_emulated/cuda_emulated.cpp cuda_emulated/textures.cpp)
chiaro_cuda_as_cpp()
target_include_directories(cuda_emulated PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/cuda_emulated ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/include)
target_compile_definitions(cuda_emulated PRIVATE CHIARO_CUDA_EMULATED)
target_link_libraries(cuda_emulated PRIVATE fmt::fmt chiaro_warnings)

add_executable(cuda_emulated_test cuda_test.cpp cuda_light_test.cpp cuda_histogram_test.cpp cuda_frame_test.cpp cuda_texture_test.cpp cuda_emulated/failures.cpp cuda_emulated/launch_counts.cpp $<TARGET_OBJECTS:cuda_emulated>) # these before the library's own
target_include_directories(cuda_emulated_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/cuda_emulated ${PROJECT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(cuda_emulated_test PRIVATE CHIARO_CUDA_EMULATED)
target_link_libraries(cuda_emulated_test PRIVATE chiaro_bench chiaro GTest::gtest_main fmt::fmt chiaro_warnings)
gtest_discover_tests(cuda_emulated_test NO_PRETTY_VALUES TEST_PREFIX Emulated DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${CHIARO_TEST_TIMEOUT})

# The tool with that GPU, for scripts/gpu_pictures.
find_package(CLI11 REQUIRED)
add_executable(chiaro_emulated EXCLUDE_FROM_ALL $<TARGET_OBJECTS:chiaro-cli> $<TARGET_OBJECTS:chiaro_tool> $<TARGET_OBJECTS:cuda_emulated>)
target_link_libraries(chiaro_emulated PRIVATE $<TARGET_PROPERTY:chiaro-cli,LINK_LIBRARIES>)

# But for what takes three seconds and more there, and goes through the same kernels as quicker tests: that the emulated GPU
# gives the host's bits is what cuda_emulated_test shows, path by path. Tests of the tool, which has another GPU or none, are
# left out too.
set(slow Transport.AHalfSpace* Transport.ThickCells* TransportEdit.ATurned* TransportEdit.TheFirst* TransportEdit.Another* TransportEdit.Interrupted*
         Reference.Interpolated* Reference.MidPlane* Reference.Converges* Spao.AnyNumber* Sweep.OnAnOpaque* LightError.Exposure* Floor.Live* LiveSurfaces.AB* LiveSurfaces.AC* LiveSurfaces.AF* LiveSurfaces.Highlights* LiveSurfaces.Steps* LiveSurfaces.AHard* HistogramCache.*
         Reference.Centre* Reference.OnAn* Reference.Surfaces* Reference.Threads* ReferenceVisibility.OnAn* ReferenceVisibility.Through* ReferenceVisibility.BandZero*
         ReferenceVisibility.Threads* Transport.AFurnace* Transport.LightThrough* Transport.AnIso* Sweep.ATurned* Visibility.AnOpen* LightError.IsWhat* LightError.Notices* LightError.Refuses*
         OneLook.Pictures* TransportSession.Warm* TransportSession.FindsLight* TransportSession.ACancelled* Channels.AreTheSumOf* Labelled.OneChannel* Labelled.AChange*
         PathTracer.Noise* PathTracer.NoPixel* Spao.Filters* Spao.WhereASurface* EveryMode/1.* EveryMode/2.* HistogramLight.IsTheSame* HistogramLight.Effects* HistogramLight.Glows*
         HistogramLight.ShowsInEvery* HistogramLight.Bleeds* HistogramLight.KeepsThe* HistogramLight.IsPrepared* HistogramLight.Without* HistogramLight.CanBe* *Tool.*)
list(JOIN slow : slow)
set(small_tests ${CHIARO_DEVICE_TESTS})
list(FILTER small_tests EXCLUDE REGEX "^(histogram|spao|transport|visibility)_error_test$|^(real_views|methods|live_surfaces|live_geometry|pattern|fit|transport_picture)_test$")
foreach(name ${small_tests})
  add_executable(${name}_emulated $<TARGET_OBJECTS:${name}> $<TARGET_OBJECTS:cuda_emulated>)
  target_link_libraries(${name}_emulated PRIVATE $<TARGET_PROPERTY:${name},LINK_LIBRARIES>)
  add_test(NAME emulated/${name} COMMAND ${name}_emulated --gtest_filter=-${slow})
  set_tests_properties(emulated/${name} PROPERTIES LABELS emulated TIMEOUT ${CHIARO_TEST_TIMEOUT} ENVIRONMENT CHIARO_TEST_DEVICE=cuda)
endforeach()
