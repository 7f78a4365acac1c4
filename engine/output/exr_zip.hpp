// SPDX-License-Identifier: MIT
// A ZIP or ZIPS file's bytes after OpenEXR's header: the table of chunks and the chunks. OpenEXR 3.1 deflates by zlib,
// at a level that costs most of a frame's writing; here it is libdeflate, and the file is one that OpenEXR could have
// written.
#pragma once

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

#include "output/atomic_file.hpp"

namespace sheaf {

/// `file` stands behind the header. The header's compression is ZIP or ZIPS, its lines go from 0 upwards, and every
/// channel has its slice in `pixels`, of its own type and without subsampling.
void write_zip_chunks(AtomicFile& file, const Imf::Header& header, const Imf::FrameBuffer& pixels);

}  // namespace sheaf
