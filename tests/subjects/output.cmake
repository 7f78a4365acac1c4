# SPDX-License-Identifier: MIT
find_package(OpenEXR 3.1 REQUIRED)
find_package(ZLIB REQUIRED)

foreach(subject atomic_file frame_names frame_range layer_set npy_writer progress stats)
  sheaf_test(${subject}_test sheaf_output)
endforeach()
sheaf_test(exr_check_test sheaf_output OpenEXR::OpenEXR)
sheaf_test(exr_writer_test sheaf_output OpenEXR::OpenEXR)
sheaf_test(exr_attributes_test sheaf_output OpenEXR::OpenEXR)
sheaf_test(png_writer_test sheaf_output ZLIB::ZLIB)
