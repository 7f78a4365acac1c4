# SPDX-License-Identifier: MIT
# The table of shader variants: name, source, defines.
foreach(stem animate_vertices animate_triangles objects_refit objects_spheres generate_primary generate_begin generate
             hash_bounds hash compress_sizes sort_count sort_spine sort_scatter decompress_fill rays_hierarchy
             traverse_single traverse_bundles traverse_pairs intersect_pairs intersect_brute shade
             resolve layers objects_boxes traverse_query packets_keys packets_frustums walk_begin pairs_open pairs_ranges
             intersect_packets classify_bounds classify_keys classify_begin classify_frustums classify_stops
             classify_candidates classify_cuts dump_triangles raster_spans)
  sheaf_shader(${stem} ${stem}.comp)
endforeach()
sheaf_shader(traverse_packets traverse_single.comp PACKETS)
sheaf_shader(raster_vert raster.vert)
sheaf_shader(raster_frag raster.frag)

# One scan, many elements: scan_elements.glsl says what each scans.
foreach(scan COMPACT COMPRESS STARTS SEGMENTED PAIRS PLAIN PLAIN_SEGMENTED)
  string(TOLOWER ${scan} stem)
  sheaf_shader(${stem}_reduce scan_reduce.comp SCAN_${scan})
  sheaf_shader(${stem}_spine scan_spine.comp SCAN_${scan})
  sheaf_shader(${stem}_scatter scan_scatter.comp SCAN_${scan})
endforeach()
foreach(scan PACKETS OPEN DIVIDE CANDIDATES CLASS_PACKETS)
  string(TOLOWER ${scan} stem)
  sheaf_shader(${stem}_reduce scan_reduce.comp SCAN_CELLS SCAN_${scan})
  sheaf_shader(${stem}_spine scan_spine.comp SCAN_CELLS SCAN_${scan})
  sheaf_shader(${stem}_scatter scan_scatter.comp SCAN_CELLS SCAN_${scan})
endforeach()
