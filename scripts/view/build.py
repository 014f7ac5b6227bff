#!/usr/bin/env python3
"""build.py - writes the page as one file that asks for nothing else, from this folder and the engines.

    build.py WASM OUT.html [SCENE_TEXT_FILE]

With a scene's text the page opens with it. The page runs from file://, where modules cannot import
each other by path: each is a data: URL with a name in the import map."""
import base64
import gzip
import json
import os
import pathlib
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
    page = (HERE / 'page.html').read_text()
    for mark, text in parts.items():
        before, after = page.split(mark)  # each is there once
        page = before + text + after
    return page


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    wasm, out = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    scene = pathlib.Path(arguments[2]).read_text() if len(arguments) == 3 else ''
    new = out.with_name(f'{out.name}.{os.getpid()}.tmp')
    try:
        new.write_text(build(wasm.read_bytes(), scene))
        os.replace(new, out)
    except OSError as error:
        new.unlink(missing_ok=True)
        sys.exit(f'cannot write {out}: {error.strerror}')


main(sys.argv[1:])
