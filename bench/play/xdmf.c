#include "xdmf.h"

#include <stdio.h>
#include <string.h>

#include "../store/export.h"

/* The data item of an HDF5 dataset: dimensions, type, file and place. */
static void write_item(FILE *file, const BenchXdmf *xdmf, const char *attributes, const char *place)
{
    const char *slash = strrchr(xdmf->data, '/');
    fprintf(file, "<DataItem %s Format=\"HDF\">", attributes);
    bench_xml_text(file, slash ? slash + 1 : xdmf->data);
    fprintf(file, ":%s</DataItem>", place);
}

static void write_field(FILE *file, const BenchXdmf *xdmf, long frame, int field)
{
    char attributes[128], place[64];
    const char *name = bench_field_names[field];
    bool vector = bench_field_components[field] > 1;
    fprintf(file, "\n<Attribute Name=\"%s\" Center=\"Node\" AttributeType=\"%s\">", name,
            vector ? "Vector" : "Scalar");
    snprintf(attributes, sizeof attributes,
             "Dimensions=\"%ld%s\" NumberType=\"Float\" Precision=\"4\"", xdmf->frame[frame].points,
             vector ? " 3" : "");
    snprintf(place, sizeof place, "/fields/%s/%ld", name, frame);
    write_item(file, xdmf, attributes, place);
    fprintf(file, "</Attribute>");
}

static void write_frame(FILE *file, const BenchXdmf *xdmf, long frame)
{
    const BenchXdmfFrame *f = &xdmf->frame[frame];
    char attributes[128], place[32];
    fprintf(file, "<Grid Name=\"frame %ld\" GridType=\"Uniform\"><Time Value=\"%.17g\"/>\n", frame,
            f->time);
    const char *type = f->corners == 3 ? "Triangle" : "Polyvertex";
    fprintf(file, "<Topology TopologyType=\"%s\" NumberOfElements=\"%ld\">", type, f->cells);
    snprintf(attributes, sizeof attributes, "Dimensions=\"%ld\" NumberType=\"Int\" Precision=\"8\"",
             f->corners * f->cells);
    snprintf(place, sizeof place, "/topologies/%ld", f->topology);
    write_item(file, xdmf, attributes, place);
    fprintf(file, "</Topology>\n<Geometry GeometryType=\"XYZ\">");
    snprintf(attributes, sizeof attributes,
             "Dimensions=\"%ld 3\" NumberType=\"Float\" Precision=\"%d\"", f->points,
             xdmf->point_bytes);
    snprintf(place, sizeof place, "/frames/%ld", frame);
    write_item(file, xdmf, attributes, place);
    fprintf(file, "</Geometry>");
    for (int i = 0; i < BENCH_POINT_FIELDS; i++)
        if (xdmf->fields & 1u << i) write_field(file, xdmf, frame, i);
    fprintf(file, "</Grid>\n");
}

static void print(FILE *file, const void *what)
{
    const BenchXdmf *xdmf = what;
    fprintf(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"2.0\"><Domain>\n");
    fprintf(file, "<Grid Name=\"");
    bench_xml_text(file, xdmf->scene);
    fprintf(file, "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
    for (long frame = 0; frame < xdmf->frames; frame++) write_frame(file, xdmf, frame);
    fprintf(file, "</Grid>\n</Domain></Xdmf>\n");
}

SmCode bench_xdmf_write(const BenchXdmf *xdmf, const BenchDraft *draft, SmError *error)
{
    return bench_draft_fill(draft, print, xdmf, error);
}
