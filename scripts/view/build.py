#!/usr/bin/env python3
"""build.py - writes the page as one file that asks for nothing else, from this folder and the engines.

    build.py WASM OUT.html SCENE_TEXT_FILE MESH_FILE [BODY_FILE...]
    build.py PAGE.html OUT.html SCENE_TEXT_FILE MESH_FILE            a page that is there, with another scene or mesh

The page opens with that scene and its mesh, or drops a mesh alone; '' stands for none. It carries these elastic
bodies (bench/view/store_body.c), and the licences of what is in it, which are beside WASM. It runs from file://, where
modules cannot import each other by path: each is a data: URL with a name in the import map."""
import base64
import contextlib
import gzip
import html
import json
import os
import pathlib
import re
import sys
import urllib.parse

HERE = pathlib.Path(__file__).resolve().parent
LICENCES = ('libconfig/COPYING.LIB', 'jansson/LICENSE', 'zlib/README',
            'suitesparse/AMD/Doc/License.txt', 'suitesparse/COLAMD/Doc/License.txt')


def encode(data):
    return base64.b64encode(data).decode()


def pack(data):
    return encode(gzip.compress(data, mtime=0))


def as_json(value):
    """JSON that may stand in a script element."""
    return json.dumps(value, ensure_ascii=False).replace('<', '\\u003c')


def build(wasm, scene, mesh, bodies, licences):
    modules = {f'view/{path.stem}': f'data:text/javascript;base64,{encode(path.read_bytes())}'
               for path in sorted(HERE.glob('*.js'))}
    shaders = {path.name: path.read_text() for path in sorted(HERE.iterdir())
               if path.suffix in ('.vert', '.frag')}
    parts = {
        '@STYLE@': (HERE / 'page.css').read_text().strip(),
        '@IMPORTS@': as_json({'imports': modules}),
        '@DATA@': as_json({'shaders': shaders, 'scene': scene, 'mesh': mesh,
                           'bodies': bodies}),
        '@LICENCES@': html.escape('\n\n'.join(licences)),
        '@WASM@': pack(wasm),
    }
    page = (HERE / 'page.html').read_text(encoding='utf-8')
    return re.sub('|'.join(parts), lambda mark: parts[mark.group()], page)


def reopen(page, scene, mesh):
    """A page with this scene and mesh in place of its own."""
    start, data, end = re.fullmatch('(.*<script id="data"[^>]*>)(.*?)(</script>.*)', page, re.DOTALL).groups()
    return start + as_json({**json.loads(data), 'scene': scene, 'mesh': mesh}) + end


def read(path, how):
    """What `how` makes of a file; '' of no file."""
    if not path:
        return ''
    try:
        return how(pathlib.Path(path))
    except (OSError, ValueError) as error:
        print(f'{path}: cannot be read: {error}', file=sys.stderr)
        sys.exit(3)


def read_mesh(path):
    """The mesh's file and, of a glTF, the files of its buffers in the same folder."""
    text = path.read_text(encoding='utf-8') if path.suffix.lower() == '.gltf' else ''
    named = {path.parent / urllib.parse.unquote(name) for name in re.findall(r'"uri"\s*:\s*"([^":]+\.bin)"', text)}
    beside = [file for file in sorted(named) if path.parent.resolve() in file.resolve().parents and file.is_file()]
    return [{'name': file.name, 'gzip': pack(file.read_bytes())} for file in (path, *beside)]


def read_body(path):
    return pack(path.read_bytes())


def main(arguments):
    if len(arguments) < 4:
        sys.exit(__doc__)
    wasm, out = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    scene = read(arguments[2], lambda path: path.read_text(encoding='utf-8'))
    mesh = read(arguments[3], read_mesh) or []
    if wasm.suffix == '.html':
        return write(out, reopen(wasm.read_text(encoding='utf-8'), scene, mesh))
    bodies = [read(path, read_body) for path in arguments[4:]]
    texts = [HERE.parents[1] / 'LICENSE', *filter(pathlib.Path.exists, (wasm.parent / name for name in LICENCES))]
    licences = [read(path, lambda at: at.read_text(encoding='utf-8').strip()) for path in texts]
    return write(out, build(wasm.read_bytes(), scene, mesh, bodies, licences))


def write(out, page):
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
