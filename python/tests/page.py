"""Executes the Python blocks of a page in order and holds what they print and draw against it.

A block ```python is executed, in one namespace with those before it; a block ```text behind it is what it prints. A picture behind
it, `![..](img/NAME.png)`, is the figure that is open then. `--write` renews both.

    python tests/page.py docs/python.md [--write] [--pictures DIRECTORY]
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

BLOCK = re.compile(r"```python\n(?P<code>.*?)```\n(?:\n```text\n(?P<text>.*?)```\n)?(?:\n!\[[^\]]*\]\((?P<picture>[^)]+)\)\n)?", re.S)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--pictures", type=Path, help="where pictures go without --write")
    asked = parser.parse_args()
    page: Path = asked.page.resolve()
    text = page.read_text()
    os.chdir(page.parent.parent)
    namespace: dict = {"__name__": "__page__"}
    faults, done = [], 0

    def executed(match: "re.Match[str]") -> str:
        nonlocal done
        line = text.count("\n", 0, match.start()) + 2
        printed = io.StringIO()
        pyplot.close("all")
        with contextlib.redirect_stdout(printed):
            code = compile("\n" * (line - 1) + match["code"], str(page), "exec")
            exec(code, namespace)
        done += 1
        found, whole = printed.getvalue(), match[0]
        if (match["text"] or "") != found:
            faults.append(f"{page.name}:{line} prints\n{found}not\n{match['text'] or ''}")
        new = f"```python\n{match['code']}```\n" + (f"\n```text\n{found}```\n" if found else "")
        if match["picture"]:
            picture = page.parent / match["picture"]
            if not asked.write:
                picture = (asked.pictures or page.parent / "img") / picture.name
            if not pyplot.get_fignums():
                faults.append(f"{page.name}:{line} draws nothing for {picture.name}")
            else:
                picture.parent.mkdir(parents=True, exist_ok=True)
                pyplot.gcf().savefig(picture, dpi=80, metadata={"Software": None})
            kept = page.parent / match["picture"]
            if not kept.exists():
                faults.append(f"{kept} is missing")
            new += whole[whole.rindex("\n![") :]
        return new

    renewed = BLOCK.sub(executed, text)
    print(f"{page.name}: {done} blocks executed")
    if asked.write:
        page.write_text(renewed)
        return 0
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults or not done else 0


if __name__ == "__main__":
    sys.exit(main())
