// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// SPZ and gzip. The first byte says whether the rest is a file as it is or what is in the gzip
// stream of one: mutated bytes would not get through its checksum.
#include "sgs/io/spz.h"

#include "harness.h"
#include "sgs/io/gzip.h"
#include "sgs/io/splat_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sgs;
  const fuzz::Choice input(data, size);
  constexpr std::size_t kLimit = 1 << 20;
  switch (input.number % 3) {
    case 0: {
      const fuzz::MemoryFile file(io::gzip_compressed(input.rest));
      (void)io::load_spz(file.path());
      break;
    }
    case 1: {
      const fuzz::MemoryFile file(input.rest);
      (void)io::load_spz(file.path());
      const auto plain = io::gzip_decompressed(input.rest, kLimit);
      fuzz::require(!plain || plain->size() <= kLimit, "the limit is kept");
      break;
    }
    default: {
      const std::size_t whole = input.rest.size() / io::kSplatRecordBytes;
      const auto splats =
          io::splats_from_records(input.rest.substr(0, whole * io::kSplatRecordBytes));
      fuzz::require(splats.size() == whole, "a splat for each record");
    }
  }
  return 0;
}
