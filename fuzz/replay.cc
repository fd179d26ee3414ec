// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs a target over the files of the folders that are named: what libFuzzer's own main does, for
// builds without it.
#include <algorithm>
#include <vector>

#include "harness.h"
#include "sgs/io/atomic_file.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> inputs;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : fs::directory_iterator(argv[i])) inputs.push_back(entry.path());
  }
  std::sort(inputs.begin(), inputs.end());
  for (const fs::path& input : inputs) {
    const auto bytes = sgs::io::read_file(input);
    sgs::fuzz::require(bytes.has_value(), "the corpus can be read");
    std::printf("%s\n", input.filename().c_str());
    std::fflush(stdout);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size());
  }
  sgs::fuzz::require(!inputs.empty(), "the corpus is not empty");
  return 0;
}
