# SPDX-License-Identifier: MIT
foreach(subject server_access server_confinement server_files server_http server_jobs server_pool server_reply server_store server_upload server_worker server_zip)
  sheaf_test(${subject}_test sheaf_server)
endforeach()
