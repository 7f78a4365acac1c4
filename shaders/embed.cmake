# SPDX-License-Identifier: MIT
# cmake -DINPUT=x.spv -DOUTPUT=x.spv.h -DNAME=x -P embed.cmake: SPIR-V as an array of words.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
file(WRITE ${OUTPUT} "#pragma once\nconst std::uint32_t ${NAME}[] = {${words}};\n")
