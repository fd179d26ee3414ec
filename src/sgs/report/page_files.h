// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace sgs::report {

/// A script or style sheet of the folder page/, by its file name. palette.css, which the viewer's
/// page uses too, is one of them.
std::string_view page_text(std::string_view name);

/// `modules` as one script element. A page that opens from disk cannot fetch modules, so they are
/// put one behind the other (what a module imports has to come before it) and their import
/// statements and the word `export` are taken away: all top-level names share one scope.
std::string script_html(std::initializer_list<std::string_view> modules);

/// The text of one module without its imports (of values, and of types in comments) and the word
/// `export`. Statements start at the start of a line and end with a semicolon at the end of one, as
/// prettier writes them.
std::string without_imports(std::string_view module_text);

}  // namespace sgs::report
