#!/usr/bin/env python3
"""build.py - writes the page as one file that asks for nothing else, from this folder and the engines.

    build.py WASM OUT.html [SCENE_TEXT_FILE]

With a scene's text the page opens with it. The page runs from file://, where modules cannot import
each other by path: each is a data: URL with a name in the import map."""
import base64
import contextlib
import gzip
import json
import os
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent


def encode(data):
    return base64.b64encode(data).decode()


def as_json(value):
    """JSON that may stand in a script element."""
    return json.dumps(value, ensure_ascii=False).replace('<', '\\u003c')


def build(wasm, scene):
    modules = {f'view/{path.stem}': f'data:text/javascript;base64,{encode(path.read_bytes())}'
               for path in sorted(HERE.glob('*.js'))}
    shaders = {path.name: path.read_text() for path in sorted(HERE.iterdir())
               if path.suffix in ('.vert', '.frag')}
    parts = {
        '@STYLE@': (HERE / 'page.css').read_text().strip(),
        '@IMPORTS@': as_json({'imports': modules}),
        '@DATA@': as_json({'shaders': shaders, 'scene': scene}),
        '@WASM@': encode(gzip.compress(wasm, mtime=0)),
    }
    page = (HERE / 'page.html').read_text(encoding='utf-8')
    return re.sub('|'.join(parts), lambda mark: parts[mark.group()], page)


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    wasm, out = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    try:
        scene = pathlib.Path(arguments[2]).read_text(encoding='utf-8') if len(arguments) == 3 else ''
    except (OSError, ValueError) as error:
        print(f'{arguments[2]}: cannot be read as text (UTF-8): {error}', file=sys.stderr)
        sys.exit(3)
    page = build(wasm.read_bytes(), scene)
    new = f'{out}.{os.getpid()}.tmp'
    try:
        pathlib.Path(new).write_text(page, encoding='utf-8')
        os.replace(new, out)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.unlink(new)
        print(f'cannot write {out}: {error.strerror}: name a file in a folder that is there', file=sys.stderr)
        sys.exit(4)


main(sys.argv[1:])
