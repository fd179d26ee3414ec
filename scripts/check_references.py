#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that what comments and documents refer to exists.

 - a path docs/NAME.md in any file; after it ", section N" or ', "Title"': that heading of the page;
   before it "(EQUATION) of": that equation;
 - a document named in capitals (NAME.md, NAME section N) in any comment;
 - relative links and anchors, source paths, module/file names and parameters of the Markdown pages;
 - each parameter for users: docs/tuning.md says when to set it;
 - the numbers that README quotes: they stand in docs/results.md;
 - the size of a page: people read it, so it is short. Generated pages are as long as they are.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ("src", "apps", "benchmarks", "tests", "scripts", "cmake", "docs", "examples", "web")
SKIPPED = {"build", "node_modules", "dist", "__pycache__"}
C_LIKE = {".h", ".cc", ".inl", ".ts", ".mjs", ".js", ".css"}
HASH_LIKE = {".py", ".sh", ".cmake", ".txt", ".toml"}
MAX_LINES, MAX_WIDTH = 200, 140
MAX_USERS_PARAMETERS = 90

# "section 3", "sections 2 to 6", "section 2 and 4", "section 3, 4, 6"
SECTIONS = r"(?:sections?|§)\s*(\d+(?:(?:\s+to\s+|\s+and\s+|,\s*)\d+)*)"


def files():
    for path in sorted(ROOT.glob("*")):
        if path.suffix == ".md" or path.name in ("demo.sh", "test.sh", "CMakeLists.txt"):
            yield path
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            known = path.suffix in C_LIKE | HASH_LIKE | {".md"}
            if known and SKIPPED.isdisjoint(path.relative_to(ROOT).parts):
                yield path


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def prose_of(path, text):
    """The text with what is no prose blanked out, so that offsets still tell the line."""
    if path.suffix == ".md":
        return re.sub(r"^```.*?^```", blank, text, flags=re.M | re.S)
    if path.suffix in C_LIKE:
        lines = (
            re.sub(r"^(.*?)//+<?", blank, line) if "//" in line else " " * len(line)
            for line in text.split("\n")
        )
        return "\n".join(lines)
    if path.suffix == ".py":
        return re.sub(r"^[ \t]*#+", blank, text, flags=re.M)
    return "\n".join(re.sub(r"^[^#]*#*", blank, line) for line in text.split("\n"))


def headings(page):
    """Titles of a page's headings, without marks."""
    text = prose_of(page, page.read_text())
    return [re.sub(r"[`*]", "", h).strip() for h in re.findall(r"^#+ +(.+?)\s*$", text, re.M)]


def anchors(page):
    """Anchors of a page as GitHub makes them."""
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in headings(page)}


def numbers_in(words):
    """'2 to 4, 7' -> 2 3 4 7."""
    found = []
    for token in re.finditer(r"(to\s+)?(\d+)", words):
        number = int(token.group(2))
        found += range(found[-1] + 1, number + 1) if token.group(1) else [number]
    return found


def missing_sections(page, words):
    titles = headings(page)
    return [n for n in numbers_in(words) if not any(t.startswith(f"{n}. ") for t in titles)]


def check_named_documents(path, text, prose, report):
    """References in running text: docs/NAME.md with a section or title, and names in capitals."""
    for match in re.finditer(r"(?<![\w/.-])docs/[\w./-]+\.md", text):
        if not (ROOT / match.group()).is_file():
            report(path, match.start(), f"there is no {match.group()}")
    for match in re.finditer(r"(docs/[\w./-]+\.md)\)?,\s+(?:" + SECTIONS + r'|"([^"]+)")', prose):
        page = ROOT / match.group(1)
        if not page.is_file():
            continue  # said above
        for number in missing_sections(page, match.group(2) or ""):
            report(path, match.start(), f"{match.group(1)} has no section {number}")
        title = re.sub(r"\s+", " ", match.group(3) or "")
        if title and not any(t.startswith(title) for t in headings(page)):
            report(path, match.start(), f'{match.group(1)} has no heading "{title}"')
    for match in re.finditer(r"(\([A-Z][A-Z ]+\))\s+of\s+(docs/[\w./-]+\.md)", prose):
        page = ROOT / match.group(2)
        if page.is_file() and match.group(1) not in page.read_text():
            report(path, match.start(), f"{match.group(2)} has no equation {match.group(1)}")
    named = r"\b([A-Z][A-Z_]{2,})(?:\.md)?,?\s+(?:" + SECTIONS + r'|"[A-Z])'
    for match in re.finditer(named, prose):
        page = ROOT / "docs" / (match.group(1).lower() + ".md")
        if not page.is_file() or missing_sections(page, match.group(2) or ""):
            report(path, match.start(), f"no document has what '{match.group()}' names")
    for match in re.finditer(r"(?<![\w/.-])[A-Z][\w-]*\.md\b", prose):
        if not any((folder / match.group()).is_file() for folder in (ROOT, path.parent)):
            report(path, match.start(), f"there is no {match.group()}")


def check_links(page, prose, report):
    for match in re.finditer(r"\]\(([^)\s]+)\)", prose):
        target, _, anchor = match.group(1).partition("#")
        if re.match(r"\w+:", match.group(1)):
            continue
        place = (page.parent / target) if target else page
        if not place.exists():
            report(page, match.start(), f"the link {match.group(1)} leads nowhere")
        elif anchor and anchor not in anchors(place):
            report(page, match.start(), f"{target or 'this page'} has no heading #{anchor}")


def check_source_paths(page, prose, report):
    """`src/sgs/...`, `scripts/...` and `module/file`, as the pages write them."""
    modules = {p.name for p in (ROOT / "src" / "sgs").iterdir() if p.is_dir()}
    for match in re.finditer(r"`([\w.-]+(?:/[\w.-]+)+/?)`", prose):
        name = match.group(1)
        head = name.split("/")[0]
        if name.endswith(".md"):
            continue  # a named document, checked as such
        if head in FOLDERS:
            found = (ROOT / name).exists()
        elif head in modules:
            base = ROOT / "src" / "sgs" / name
            found = base.exists() or base.with_suffix(".h").exists()
        else:
            continue
        if not found:
            report(page, match.start(), f"there is no {name}")


def parameter_keys(page):
    """The keys in the table of that generated page."""
    return re.findall(r"^\| `([\w.]+)`", (ROOT / "docs" / page).read_text(), re.M)


def check_parameters(page, text, report):
    """Configuration keys, written in full: each is a row, or the group of some rows, of the list."""
    known = parameter_keys("parameters.md") + parameter_keys("parameters-expert.md")
    for match in re.finditer(r"(?<![\w/.-])(?:slam|tracker|mapper)\.[a-z][\w.]*\w", text):
        key = match.group()
        if not key.endswith((".h", ".cc")) and not any(
            f"{k}.".startswith(f"{key}.") for k in known
        ):
            report(page, match.start(), f"there is no parameter {key}")


def check_size(page, text, report):
    lines = text.split("\n")
    if any("Generated by" in line for line in lines[:5]):
        return
    if len(lines) > MAX_LINES + 1:
        report(page, 0, f"{len(lines) - 1} lines; a page has at most {MAX_LINES}")
    offset, generated = 0, False
    for line in lines:
        generated = line.startswith("<!-- begin") or (generated and not line.startswith("<!-- end"))
        if (
            not generated
            and len(line) > MAX_WIDTH
            and not line.lstrip().startswith(("|", "<!--", "- ["))
        ):
            report(page, offset, f"{len(line)} characters in a line; at most {MAX_WIDTH}")
        offset += len(line) + 1


def check_blocks(page, text, report):
    """Blocks that tools write stand between <!-- begin NAME --> and <!-- end NAME -->."""
    open_block = None
    for match in re.finditer(r"<!-- (begin|end) ([\w-]+)", text):
        kind, name = match.groups()
        if (kind == "begin") == (open_block is not None) or (kind == "end" and name != open_block):
            report(page, match.start(), f"the marker '{kind} {name}' has no partner")
        open_block = name if kind == "begin" else None
    if open_block:
        report(page, len(text), f"the block {open_block} does not end")


def check_index(report):
    """Each decision has its line in the index."""
    index = ROOT / "docs" / "decisions" / "README.md"
    for page in sorted(index.parent.glob("[0-9]*.md")):
        if f"]({page.name})" not in index.read_text():
            report(index, 0, f"{page.name} is missing")


def check_users_parameters(report):
    """A parameter for users is one of which the page on tuning says when to set it; they are few."""
    page = ROOT / "docs" / "parameters.md"
    keys = parameter_keys(page.name)
    told = (ROOT / "docs" / "tuning.md").read_text()
    for key in keys:
        if f"`{key}`" not in told:
            report(page, 0, f"docs/tuning.md does not say when to set {key}")
    if len(keys) > MAX_USERS_PARAMETERS:
        report(page, 0, f"{len(keys)} parameters for users; at most {MAX_USERS_PARAMETERS}")


def check_quoted_numbers(report):
    """Numbers between README's markers `numbers` stand in docs/results.md, digit for digit."""
    readme = ROOT / "README.md"
    text = readme.read_text()
    number = r"(?<![\w.])\d+(?:\.\d+)?(?![\w-])"
    known = set(re.findall(number, (ROOT / "docs" / "results.md").read_text()))
    block = re.search(r"<!-- begin numbers.*?-->(.*?)<!-- end numbers -->", text, re.S)
    if not block:
        report(readme, 0, "the block 'numbers' is missing")
        return
    for match in re.finditer(number, block.group(1)):
        if match.group() not in known:
            report(
                readme,
                block.start(1) + match.start(),
                f"{match.group()} does not stand in docs/results.md",
            )


def main():
    problems = []

    def report(path, offset, what):
        line = path.read_text().count("\n", 0, offset) + 1
        problems.append(f"{path.relative_to(ROOT)}:{line}: {what}")

    count = 0
    for path in files():
        if path == pathlib.Path(__file__).resolve():
            continue
        count += 1
        text = path.read_text()
        prose = prose_of(path, text)
        check_named_documents(path, text, prose, report)
        if path.suffix == ".md":
            check_links(path, prose, report)
            check_blocks(path, text, report)
            history = path.name == "CHANGELOG.md" or path.parent.name == "decisions"
            if not history:  # history may name what is gone
                check_source_paths(path, prose, report)
                check_parameters(path, text, report)
            if path.is_relative_to(ROOT / "docs"):
                check_size(path, text, report)
    check_index(report)
    check_users_parameters(report)
    check_quoted_numbers(report)
    for problem in problems:
        print(problem)
    print(f"{count} files, {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
