# What Octavo stands on, each with the reason it is here. All are Debian 12 packages.
find_package(PkgConfig REQUIRED)

find_package(TBB REQUIRED)       # threads: parallel loops and the ordered build pipeline
if(OCTAVO_SANITIZE MATCHES "thread" AND NOT TBB_DIR MATCHES "tsan-tbb")
    message(WARNING "This oneTBB was not compiled for the thread sanitizer, which will report races "
                    "that are none: run scripts/tsan-tbb, then configure anew.")
endif()
find_package(glm REQUIRED)       # vectors with GLSL's names, which the shared ray text needs
find_package(nlohmann_json REQUIRED)  # JSON: file metadata, --json output
find_package(hwy REQUIRED)       # SIMD with run-time dispatch, for the voxel overlap kernel
find_package(ZLIB REQUIRED)      # gzipped meshes
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)  # checksums of file sections
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)      # optional compressed sections
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)        # what a build spills to its scratch folder

find_package(assimp REQUIRED)    # the many mesh formats that we do not read ourselves
find_package(draco REQUIRED)     # glTF meshes packed by KHR_draco_mesh_compression
find_package(meshoptimizer REQUIRED)  # and by EXT_meshopt_compression
find_package(PNG REQUIRED)       # pictures, and the textures of scenes
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)  # textures of scenes, pictures that `octavo view` sends
find_package(OpenEXR REQUIRED)   # pictures in linear floats

# Optional: builds by many machines together (packages libopenmpi-dev, openmpi-bin).
set(MPI_CXX_SKIP_MPICXX ON)
find_package(MPI QUIET COMPONENTS CXX)

if(OCTAVO_BUILD_APPS)
    find_package(CLI11 REQUIRED)  # command-line arguments
    find_package(fmt REQUIRED)    # tables: g++ 12 has no std::format
    # Optional: the server of `octavo view`.
    pkg_check_modules(HTTPLIB IMPORTED_TARGET cpp-httplib)
endif()
if(OCTAVO_BUILD_TESTS)
    find_package(GTest REQUIRED)
endif()

# Optional: the Vulkan backend. Only headers (libvulkan-dev), because the library is looked for when
# the program runs, and glslc, because it follows #include and writes what C++ can embed.
find_package(Vulkan QUIET)
find_program(OCTAVO_GLSLC glslc)
option(OCTAVO_VULKAN "Build the Vulkan backend where its headers and glslc are found" ON)
set(OCTAVO_HAS_VULKAN OFF)
if(OCTAVO_VULKAN AND Vulkan_INCLUDE_DIRS AND OCTAVO_GLSLC)
    set(OCTAVO_HAS_VULKAN ON)
endif()
message(STATUS "Vulkan backend: ${OCTAVO_HAS_VULKAN}")

# Optional: the CUDA backend, wherever a toolkit is: 12.0 or newer, for GPUs from sm_75 on.
option(OCTAVO_CUDA "Build the CUDA backend where a toolkit is found" ON)
set(OCTAVO_HAS_CUDA OFF)
if(OCTAVO_CUDA)
    find_package(CUDAToolkit 12.0 QUIET)
    if(CUDAToolkit_FOUND AND CUDAToolkit_NVCC_EXECUTABLE)
        set(OCTAVO_HAS_CUDA ON)
        if(NOT CMAKE_CUDA_COMPILER)
            set(CMAKE_CUDA_COMPILER ${CUDAToolkit_NVCC_EXECUTABLE})
        endif()
        if(NOT CMAKE_CUDA_ARCHITECTURES)
            set(CMAKE_CUDA_ARCHITECTURES 75-real 80-real 90)  # 90: PTX too, for what comes later
        endif()
        set(CMAKE_CUDA_STANDARD 20)
        enable_language(CUDA)
        if(CMAKE_VERSION VERSION_LESS 3.25.2 OR NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
            # CMake 3.25 does not know that nvcc 12 has C++20.
            set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
            set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
            set(CMAKE_CUDA20_COMPILE_FEATURES cuda_std_20)
            list(APPEND CMAKE_CUDA_COMPILE_FEATURES cuda_std_20)
        endif()
    endif()
endif()
message(STATUS "CUDA backend: ${OCTAVO_HAS_CUDA}")
