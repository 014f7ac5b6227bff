// mesh_files.js - the mesh files that the page reads, which the program reads through Assimp: each format's
// reader makes polygons of a file's bytes, or throws an error whose message says what is wrong with it.
import { readObj } from 'view/mesh_obj';
import { readOff } from 'view/mesh_off';
import { readPly } from 'view/mesh_ply';
import { readStl } from 'view/mesh_stl';

export const LARGEST = 400e6; // bytes, as text of a million triangles at most
const READERS = { obj: readObj, off: readOff, ply: readPly, stl: readStl };

const suffixOf = (name) => /\.([^./\\]*)$/.exec(name)?.[1].toLowerCase() ?? '';

export const isMeshFile = (name) => suffixOf(name) in READERS;

// The name as a scene's text and messages can have it.
export const plainName = (name) => name.replace(/^.*[/\\]/, '').replace(/["\p{C}]|^shape:/gu, '_');

// { points: Float64Array, sizes, corners: Int32Array }: three numbers a vertex, the corners of each polygon,
// and which vertices those are.
export function readMesh(name, bytes) {
    if (!bytes.length) throw new Error('the file is empty');
    return READERS[suffixOf(name)](bytes);
}
