# SPDX-License-Identifier: MIT
foreach(subject server_http server_jobs server_upload server_worker server_zip)
  sheaf_test(${subject}_test sheaf_server)
endforeach()
