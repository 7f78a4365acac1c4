# SPDX-License-Identifier: MIT
sheaf_test(gltf_loader_test sheaf_scene)
sheaf_test(gltf_malformed_test sheaf_scene)
sheaf_test(gltf_file_test sheaf_scene)
sheaf_test(pose_test sheaf_scene)
sheaf_test(camera_path_test sheaf_scene)
sheaf_test(gltf_sloppy_test sheaf_scene)
sheaf_test(file_kind_test sheaf_scene)
