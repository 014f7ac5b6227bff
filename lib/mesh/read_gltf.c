/* glTF 2.0 and GLB: the default scene in its bind pose. */
#include "draft.h"

#ifdef SM_JANSSON
#include <jansson.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define FAIL(...) sm_draft_fail(gltf->draft, __VA_ARGS__)

enum { DEEPEST = 256 }; /* nodes within nodes: bounds the stack */
enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN };

typedef struct {
    char *owned; /* NULL: the bytes are the file's */
    const char *bytes;
    size_t size;
} Buffer;

typedef struct {
    SmDraft *draft;
    json_t *root;
    Buffer chunk; /* of bytes in a GLB */
    Buffer *buffer;
    size_t buffers;
} Gltf;

typedef struct {
    double row[3][4];
} Transform;

static const Transform identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/* ---- JSON */

/* Calls json_unpack(), whose format says what the object must have and what it may have. */
static bool unpack_json(Gltf *gltf, json_t *object, const char *format, ...)
{
    json_error_t why;
    va_list arguments;
    va_start(arguments, format);
    bool good = !json_vunpack_ex(object, &why, 0, format, arguments);
    va_end(arguments);
    return good || FAIL("%s" SM_AGAIN, why.text);
}

static json_t *get_item(Gltf *gltf, const char *list, double index)
{
    json_t *array = json_object_get(gltf->root, list);
    bool inside = index >= 0 && index < (double)json_array_size(array);
    json_t *item = inside ? json_array_get(array, (size_t)index) : NULL;
    if (json_is_object(item)) return item;
    FAIL("%s[%.0f] is not in the file" SM_AGAIN, list, index);
    return NULL;
}

static bool check_version(Gltf *gltf)
{
    static const char *const harmless[] = {
        "KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_materials_",     "KHR_texture_",
        "EXT_texture_",          "MSFT_texture_dds",        "KHR_lights_punctual"};
    const json_t *required = json_object_get(gltf->root, "extensionsRequired");
    const char *version;
    if (!unpack_json(gltf, gltf->root, "{s:{s:s}}", "asset", "version", &version)) return false;
    if (version[0] != '2') return FAIL("glTF %.20s is not read; export it as glTF 2.0", version);
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        size_t known = 0;
        while (known < 7 && strncmp(name ? name : "", harmless[known], strlen(harmless[known])))
            known++;
        if (known == 7)
            return FAIL("it needs the extension %.60s, which is not read; export it "
                        "without",
                        name ? name : "of no name");
    }
    return true;
}

/* ---- buffers */

static bool decode_base64(const char *text, Buffer *buffer)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned bits = 0;
    const char *digit;
    buffer->owned = sm_alloc(strlen(text), 1);
    for (int count = 1; *text && (digit = strchr(digits, *text)); text++, count++) {
        bits = bits << 6 | (unsigned)(digit - digits);
        if (count % 4 != 1) buffer->owned[buffer->size++] = (char)(bits >> (8 - count % 4 * 2) % 8);
    }
    return !text[strspn(text, "=")];
}

/* Puts the characters that %20 and the like stand for in their place. */
static void decode_name(const char *uri, char *name)
{
    for (; *uri; uri++) {
        char hex[3] = {uri[0] == '%' ? uri[1] : 0, uri[0] == '%' && uri[1] ? uri[2] : 0, 0}, *end;
        long code = strtol(hex, &end, 16);
        bool coded = end == hex + 2 && code > 0;
        *name++ = coded ? (char)code : *uri;
        uri += coded ? 2 : 0;
    }
    *name = 0;
}

static bool read_gltf_file(Gltf *gltf, const char *uri, Buffer *buffer)
{
    const SmMeshFile *file = gltf->draft->file;
    char *name = sm_alloc(strlen(uri) + 1, 1);
    unsigned char *bytes = NULL;
    decode_name(uri, name);
    if (!file->beside || !file->beside(file->of, name, &bytes, &buffer->size))
        FAIL("it needs '%.100s', which is not in its folder; put it there, or export as .glb",
             name);
    buffer->owned = (char *)bytes;
    free(name);
    return bytes != NULL;
}

static bool read_gltf_buffer(Gltf *gltf, size_t index)
{
    Buffer *buffer = &gltf->buffer[index];
    json_t *json = get_item(gltf, "buffers", (double)index);
    const char *uri = NULL;
    double length;
    if (!json || !unpack_json(gltf, json, "{s:F, s?s}", "byteLength", &length, "uri", &uri))
        return false;
    if (!uri && index == 0) *buffer = gltf->chunk;
    if (!uri && !buffer->bytes) return true; /* an extension's; refused where it is used */
    const char *data = uri && !strncmp(uri, "data:", 5) ? strstr(uri, ";base64,") : NULL;
    if (data && !decode_base64(data + 8, buffer))
        return FAIL("buffers[%zu] is not base64" SM_AGAIN, index);
    if (uri && !data && !read_gltf_file(gltf, uri, buffer)) return false;
    if (buffer->owned) buffer->bytes = buffer->owned;
    gltf->draft->most += buffer->owned ? (double)buffer->size : 0;
    if (length <= (double)buffer->size) return true;
    return FAIL("buffers[%zu] has %zu of %.0f bytes" SM_AGAIN, index, buffer->size, length);
}

static bool read_buffers(Gltf *gltf)
{
    gltf->buffers = json_array_size(json_object_get(gltf->root, "buffers"));
    gltf->buffer = sm_alloc(gltf->buffers, sizeof *gltf->buffer);
    for (size_t b = 0; b < gltf->buffers; b++)
        if (!read_gltf_buffer(gltf, b)) return false;
    return true;
}

/* ---- accessors */

/* Elements in a buffer: numbers of one type. */
typedef struct {
    const char *at;
    double stride; /* bytes from one element to the next */
    SmNumberType type;
    size_t parts; /* numbers of an element */
    bool normalized;
} Elements;

static bool set_type(Gltf *gltf, double type, Elements *elements)
{
    if (!(type >= 5120 && type <= 5126 && type != 5124))
        return FAIL("%.0f is not a type of numbers in glTF" SM_AGAIN, type);
    elements->type = (SmNumberType)(type - 5120);
    return true;
}

/* Finds `count` elements in a view of a buffer. */
static bool find_elements(Gltf *gltf, double view, double offset, double count, Elements *elements)
{
    double size = (double)elements->parts * sm_number_size(elements->type);
    double index, length, start = 0;
    json_t *json = get_item(gltf, "bufferViews", view);
    elements->stride = size;
    if (!json || !unpack_json(gltf, json, "{s:F, s:F, s?F, s?F}", "buffer", &index, "byteLength",
                              &length, "byteOffset", &start, "byteStride", &elements->stride))
        return false;
    bool inside = index >= 0 && index < (double)gltf->buffers;
    const Buffer *buffer = inside ? &gltf->buffer[(size_t)index] : NULL;
    if (!buffer || !buffer->bytes || start < 0 || length < 0 ||
        start + length > (double)buffer->size || elements->stride < size ||
        elements->stride > 1e9 || offset < 0 || count < 0 || count > INT_MAX ||
        (count > 0 && offset + (count - 1) * elements->stride + size > length))
        return FAIL("an accessor reaches beyond its buffer" SM_AGAIN);
    elements->at = buffer->bytes + (size_t)start + (size_t)offset;
    return true;
}

static void copy_element(const Elements *elements, size_t from, double *value)
{
    static const double most[] = {127, 255, 32767, 65535};
    const char *at = elements->at + from * (size_t)elements->stride;
    for (size_t p = 0; p < elements->parts; p++, at += sm_number_size(elements->type)) {
        value[p] = sm_number_at(at, elements->type, false);
        if (elements->normalized && elements->type <= SM_U16)
            value[p] = fmax(value[p] / most[elements->type], -1);
    }
}

/* Replaces those of `count` elements that the sparse accessor names. */
static bool apply_sparse(Gltf *gltf, json_t *sparse, Elements *values, double count, double *value)
{
    double changed, type, view[2], offset[2] = {0};
    Elements indices = {.parts = 1};
    if (!unpack_json(gltf, sparse, "{s:F, s:{s:F, s:F, s?F}, s:{s:F, s?F}}", "count", &changed,
                     "indices", "bufferView", &view[0], "componentType", &type, "byteOffset",
                     &offset[0], "values", "bufferView", &view[1], "byteOffset", &offset[1]) ||
        !set_type(gltf, type, &indices) ||
        !find_elements(gltf, view[0], offset[0], changed, &indices) ||
        !find_elements(gltf, view[1], offset[1], changed, values))
        return false;
    for (size_t i = 0; i < (size_t)changed; i++) {
        double element;
        copy_element(&indices, i, &element);
        if (!(element >= 0 && element < count && element == floor(element)))
            return FAIL("a sparse accessor changes element %.0f" SM_AGAIN, element);
        copy_element(values, i, value + (size_t)element * values->parts);
    }
    return true;
}

/* Reads the accessor that object[key] names, whose elements are `kind`. Returns NULL after an
 * error; the caller frees. */
static double *read_accessor(Gltf *gltf, json_t *object, const char *key, const char *kind,
                             long *count)
{
    double index, type, number, view = -1, offset = 0;
    const char *is;
    json_t *accessor, *sparse = NULL;
    int normalized = 0;
    if (!unpack_json(gltf, object, "{s:F}", key, &index) ||
        !(accessor = get_item(gltf, "accessors", index)) ||
        !unpack_json(gltf, accessor, "{s:F, s:F, s:s, s?F, s?F, s?b, s?o}", "componentType", &type,
                     "count", &number, "type", &is, "bufferView", &view, "byteOffset", &offset,
                     "normalized", &normalized, "sparse", &sparse))
        return NULL;
    Elements elements = {.parts = kind[0] == 'S' ? 1 : (size_t)(kind[3] - '0')};
    elements.normalized = normalized;
    bool good = set_type(gltf, type, &elements);
    if (good &&
        (strcmp(is, kind) != 0 || !(number >= 0 && number <= fmin(3 * gltf->draft->most, INT_MAX))))
        good = FAIL("%s is not %s, or too many" SM_AGAIN, key, kind);
    bool given = !sparse || view >= 0;
    if (!good || (given && !find_elements(gltf, view, offset, number, &elements))) return NULL;
    double *value = sm_alloc((size_t)number * elements.parts, sizeof *value);
    for (size_t i = 0; given && i < (size_t)number; i++)
        copy_element(&elements, i, value + i * elements.parts);
    *count = (long)number;
    if (!sparse || apply_sparse(gltf, sparse, &elements, number, value)) return value;
    free(value);
    return NULL;
}

/* ---- transforms */

static void compose(const Transform *outer, const Transform *inner, Transform *whole)
{
    sm_pose_compose((const double(*)[4])outer->row, (const double(*)[4])inner->row, whole->row);
}

/* Scales, turns by the quaternion, and moves. */
static Transform transform_of(const double move[3], const double turn[4], const double scale[3])
{
    double length = sqrt(sm_dot(turn, turn) + turn[3] * turn[3]);
    double x = turn[0] / length, y = turn[1] / length, z = turn[2] / length, w = turn[3] / length;
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    Transform result;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) result.row[i][j] = r[i][j] * scale[j];
        result.row[i][3] = move[i];
    }
    return result;
}

static bool get_transform(Gltf *gltf, json_t *node, Transform *transform)
{
    double m[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    double(*r)[4] = transform->row, zero, one;
    if (json_object_get(node, "matrix"))
        return unpack_json(gltf, node, "{s:[FFFFFFFFFFFFFFFF]}", "matrix", &r[0][0], &r[1][0],
                           &r[2][0], &zero, &r[0][1], &r[1][1], &r[2][1], &zero, &r[0][2], &r[1][2],
                           &r[2][2], &zero, &r[0][3], &r[1][3], &r[2][3], &one);
    if (!unpack_json(gltf, node, "{s?[FFF], s?[FFFF], s?[FFF]}", "translation", &m[0], &m[1], &m[2],
                     "rotation", &q[0], &q[1], &q[2], &q[3], "scale", &s[0], &s[1], &s[2]))
        return false;
    *transform = transform_of(m, q, s);
    return true;
}

/* ---- meshes */

static bool add_gltf_vertices(Gltf *gltf, const Transform *transform, const double *position,
                              long count)
{
    for (long v = 0; v < count; v++) {
        double p[3];
        for (int d = 0; d < 3; d++)
            p[d] = sm_dot(transform->row[d], position + 3 * v) + transform->row[d][3];
        if (!sm_draft_vertex(gltf->draft, p, NULL)) return false;
    }
    return true;
}

/* Adds triangles of `count` corners: vertices that are added next, in turn or by their `index`. */
static bool add_gltf_triangles(Gltf *gltf, int mode, bool mirrored, const double *index, long count)
{
    SmDraft *draft = gltf->draft;
    double first = (double)draft->mesh.vertex_count;
    long step = mode == TRIANGLES ? 3 : 1;
    if (count % step) return sm_draft_fail(draft, "triangles of %ld corners" SM_AGAIN, count);
    for (long c = 0; c + 2 < count; c += step) {
        bool turned = mirrored != (mode == STRIP && c % 2);
        const long at[3] = {mode == FAN ? 0 : c, turned ? c + 2 : c + 1, turned ? c + 1 : c + 2};
        for (int k = 0; k < 3; k++)
            if (!sm_draft_corner(draft, first + (index ? index[at[k]] : (double)at[k])))
                return false;
        if (!sm_draft_face(draft)) return false;
    }
    return true;
}

/* Adds a primitive's vertices and triangles; of points wanted, its points. */
static bool add_gltf_primitive(Gltf *gltf, json_t *primitive, const Transform *transform)
{
    SmDraft *draft = gltf->draft;
    int mode = TRIANGLES;
    json_t *attributes, *indices = NULL, *extensions = NULL;
    if (!unpack_json(gltf, primitive, "{s:o, s?i, s?o, s?o}", "attributes", &attributes, "mode",
                     &mode, "indices", &indices, "extensions", &extensions))
        return false;
    const char *name = json_object_iter_key(json_object_iter(extensions));
    if (name && strstr(name, "compression"))
        return sm_draft_fail(
            draft, "it uses the extension %.60s, which is not read; export it without", name);
    long vertices, corners, known = draft->mesh.vertex_count;
    double *position = read_accessor(gltf, attributes, "POSITION", "VEC3", &vertices);
    double *index = indices ? read_accessor(gltf, primitive, "indices", "SCALAR", &corners) : NULL;
    bool good = position && (index || !indices), solid = mode >= TRIANGLES && mode <= FAN;
    if (good && !indices) corners = vertices;
    bool mirrored = sm_pose_mirrors((const double(*)[4])transform->row);
    if (good && mode == POINTS) draft->left_out.points += corners;
    if (good && mode != POINTS && !solid)
        draft->left_out.lines += mode == LINES ? corners / 2 : corners - (mode == LINE_STRIP);
    if (good && solid && !draft->of_points)
        good = add_gltf_triangles(gltf, mode, mirrored, index, corners) &&
               (draft->largest < known + vertices ||
                FAIL("a triangle names vertex %ld of %ld (counted from 0)" SM_AGAIN,
                     draft->largest - known, vertices));
    if (good && (draft->of_points ? mode == POINTS : solid))
        good = add_gltf_vertices(gltf, transform, position, vertices);
    sm_free_all(position, index);
    return good;
}

static bool add_mesh(Gltf *gltf, json_t *mesh, const Transform *transform)
{
    const json_t *list = json_object_get(mesh, "primitives");
    for (size_t p = 0; p < json_array_size(list); p++)
        if (!add_gltf_primitive(gltf, json_array_get(list, p), transform)) return false;
    return true;
}

/* A node's weights replace its mesh's (glTF 2.0, 3.7.2.2). */
static bool check_weights(Gltf *gltf, const json_t *node, const json_t *mesh)
{
    const json_t *own = json_object_get(node, "weights");
    const json_t *weights = own ? own : json_object_get(mesh, "weights");
    for (size_t w = 0; w < json_array_size(weights); w++)
        if (json_number_value(json_array_get(weights, w)) != 0)
            return FAIL("it uses morph targets, which are not read; apply them before exporting");
    return true;
}

/* Adds the mesh once for each instance of EXT_mesh_gpu_instancing. */
static bool add_instances(Gltf *gltf, json_t *mesh, json_t *attributes, const Transform *transform)
{
    static const char *const key[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    static const char *const kind[3] = {"VEC3", "VEC4", "VEC3"};
    static const double absent[3][4] = {{0}, {0, 0, 0, 1}, {1, 1, 1}};
    double *value[3] = {NULL};
    long count = -1, own;
    bool good = true;
    for (int k = 0; k < 3 && good; k++) {
        if (!json_object_get(attributes, key[k])) continue;
        value[k] = read_accessor(gltf, attributes, key[k], kind[k], &own);
        good = value[k] &&
               (count < 0 || count == own || FAIL("instances of different counts" SM_AGAIN));
        count = own;
    }
    for (long i = 0; i < count && good; i++) {
        const double *of[3];
        for (int k = 0; k < 3; k++) of[k] = value[k] ? value[k] + (k == 1 ? 4 : 3) * i : absent[k];
        Transform inner = transform_of(of[0], of[1], of[2]), whole;
        compose(transform, &inner, &whole);
        good = add_mesh(gltf, mesh, &whole);
    }
    sm_free_all(value[0], value[1], value[2]);
    return good;
}

/* Adds the nodes of a list and those within them. The transform of a skinned mesh's node does not
 * count (glTF 2.0, 3.7.3.3). */
static bool add_gltf_nodes(Gltf *gltf, const json_t *list, const Transform *outer, int depth)
{
    for (size_t n = 0; n < json_array_size(list); n++) {
        json_t *node = get_item(gltf, "nodes", json_number_value(json_array_get(list, n)));
        json_t *children = NULL, *skin = NULL, *instances = NULL, *mesh = NULL;
        Transform own;
        double index = -1;
        if (!node || !get_transform(gltf, node, &own) ||
            !unpack_json(gltf, node, "{s?F, s?o, s?o, s?{s?{s:o}}}", "mesh", &index, "children",
                         &children, "skin", &skin, "extensions", "EXT_mesh_gpu_instancing",
                         "attributes", &instances))
            return false;
        if (depth == DEEPEST || json_object_get(node, " "))
            return FAIL("a node is in two others, or in more than %d" SM_AGAIN, DEEPEST);
        json_object_set_new(node, " ", json_true()); /* it was here */
        Transform whole;
        compose(outer, &own, &whole);
        if (index >= 0 && !(mesh = get_item(gltf, "meshes", index))) return false;
        if (mesh && !check_weights(gltf, node, mesh)) return false;
        if (mesh && !(instances ? add_instances(gltf, mesh, instances, &whole)
                                : add_mesh(gltf, mesh, skin ? &identity : &whole)))
            return false;
        if (!add_gltf_nodes(gltf, children, &whole, depth + 1)) return false;
    }
    return true;
}

static bool add_gltf_scene(Gltf *gltf)
{
    double number = 0;
    size_t count = json_array_size(json_object_get(gltf->root, "scenes"));
    if (!unpack_json(gltf, gltf->root, "{s?F}", "scene", &number)) return false;
    if (!count) return FAIL("it has no scene; export it with one");
    gltf->draft->left_out.scenes = (long)count - 1;
    const json_t *scene = get_item(gltf, "scenes", number);
    return scene && add_gltf_nodes(gltf, json_object_get(scene, "nodes"), &identity, 0);
}

/* ---- the file */

/* Finds the chunks of a GLB, of text and perhaps of bytes; a glTF is text. */
static bool split_chunks(Gltf *gltf, Buffer *text)
{
    SmDraft *draft = gltf->draft;
    size_t size = (size_t)(draft->end - draft->begin);
    *text = (Buffer){.bytes = draft->begin, .size = size};
    if (size < 20 || memcmp(draft->begin, "glTF", 4) != 0) return true;
    double version = sm_number_at(draft->begin + 4, SM_U32, false);
    if (version != 2)
        return sm_draft_fail(draft, "GLB %.0f is not read; export it as glTF 2.0", version);
    draft->at = draft->begin + 12;
    for (Buffer *chunk = text; draft->end - draft->at >= 8; chunk = &gltf->chunk) {
        chunk->size = (size_t)sm_number_at(draft->at, SM_U32, false);
        chunk->bytes = draft->at + 8;
        if (chunk->size > (size_t)(draft->end - chunk->bytes) ||
            memcmp(draft->at + 4, chunk == text ? "JSON" : "BIN", 4) != 0)
            return sm_draft_fail(draft, "a chunk of another kind, or cut off" SM_AGAIN);
        draft->at = chunk->bytes + chunk->size;
        if (chunk == &gltf->chunk) break;
    }
    return true;
}

/* Names in Latin-1 are not JSON: their letters become question marks. */
static bool load_json(Gltf *gltf, const Buffer *text)
{
    json_error_t why;
    gltf->root = json_loadb(text->bytes, text->size, JSON_ALLOW_NUL, &why);
    if (!gltf->root && json_error_code(&why) == json_error_invalid_utf8) {
        char *plain = sm_copy(text->bytes, text->size, 1);
        for (size_t i = 0; i < text->size; i++) plain[i] = plain[i] & 0x80 ? '?' : plain[i];
        gltf->root = json_loadb(plain, text->size, JSON_ALLOW_NUL, &why);
        free(plain);
    }
    return gltf->root || FAIL("line %d: %s" SM_AGAIN, why.line, why.text);
}

bool sm_read_gltf(SmDraft *draft)
{
    Gltf gltf = {.draft = draft};
    Buffer text;
    draft->line = 0;
    bool good = split_chunks(&gltf, &text);
    draft->at = NULL;
    good = good && load_json(&gltf, &text) && check_version(&gltf) && read_buffers(&gltf) &&
           add_gltf_scene(&gltf);
    for (size_t b = 0; gltf.buffer && b < gltf.buffers; b++) free(gltf.buffer[b].owned);
    free(gltf.buffer);
    json_decref(gltf.root);
    return good;
}

#else
bool sm_read_gltf(SmDraft *draft)
{
    draft->at = NULL;
    return sm_draft_fail(draft, "glTF is read with jansson, which this program was built without; "
                                "save it as OBJ, PLY, STL or OFF");
}
#endif
