// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::cameras {

/// Where the library of a family of cameras is looked for.
struct LibrarySearch {
  std::string name;        ///< "librealsense2": also the file's, before ".so"
  std::string versions;    ///< of files with a version in their name: "librealsense2.so.2.*"
  std::string variable;    ///< of the environment; names a file
  std::string to_install;  ///< what to do where there is none
};

/// Opens a file as a library and never closes it: it may have threads of its own. Null: no such
/// library.
void* open_library_file(const std::string& path);

/// The file that the variable names, if it does. Error: it cannot be opened.
Result<std::optional<std::string>> library_given(const LibrarySearch& search);

/// NAME.so, as the loader finds it, then the files with a version in the usual folders, newest
/// first.
std::vector<std::string> library_candidates(const LibrarySearch& search);

/// Looks for functions by their names.
class Symbols {
 public:
  Symbols(void* handle, std::string asked) : handle_(handle), path_(std::move(asked)) {}

  template <class Function>
  void find(Function*& function, const char* name) {
    function = reinterpret_cast<Function*>(look_up(name));
  }
  /// The file that the first function was found in, else the one that was asked for.
  const std::string& path() const { return path_; }
  /// The first function that was not found; empty: none.
  const std::string& missing() const { return missing_; }

 private:
  void* look_up(const char* name);

  void* handle_;
  std::string path_, missing_;
  bool found_ = false;
};

/// The file behind links: its name says the version, where nothing else does.
std::string real_path(const std::string& path);

/// What a library lacks, or that it is none; `first` is a function that each of them has.
Status check_symbols(const Symbols& symbols, const LibrarySearch& search, bool has_first,
                     const std::string& first, const std::string& version_text);

/// The first library that `accept(handle, path)` likes. Errors: none, the one that the variable
/// names cannot be opened, and why the first one was not accepted.
template <class Accept>
auto open_library(const LibrarySearch& search, const Accept& accept)
    -> std::invoke_result_t<Accept, void*, std::string> {
  SGS_ASSIGN_OR_RETURN(const auto given, library_given(search));
  if (given) return accept(open_library_file(*given), *given);
  std::optional<Error> problem;
  for (const std::string& candidate : library_candidates(search)) {
    void* handle = open_library_file(candidate);
    if (handle == nullptr) continue;
    auto library = accept(handle, candidate);
    if (library) return library;
    if (!problem) problem = library.error();
  }
  if (problem) return tl::unexpected<Error>(*problem);
  return fail(ErrorCode::kNotFound, search.name + " is not installed", search.to_install);
}

}  // namespace sgs::cameras
