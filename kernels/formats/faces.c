/* The faces between cells in upper-triangular order: by owner, the lower cell, and then by neighbour. Cells are visited
   in order, and each has at most six faces, so that nothing need be sorted but these. */
#include "faces.h"

/* Corners of the face at each side, seen from outside counter-clockwise; bit 0 is along i, bit 1 along j, bit 2 along k. */
static const unsigned char CORNERS[6][4] = {
    {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6},
};

typedef struct {
    int32_t cell;
    int side;
} face_to;

static int add(face_to *faces, int count, int32_t own, int32_t cell, int side)
{
    if (cell <= own)
        return count;
    int at = count;
    for (; at > 0 && faces[at - 1].cell > cell; at--)
        faces[at] = faces[at - 1];
    faces[at] = (face_to){cell, side};
    return count + 1;
}

ptrdiff_t inner_faces(const cell_block *block, face_lists out)
{
    const ptrdiff_t ni = block->ni, nj = block->nj, nk = block->nk, row = ni + 1, plane = row * (nj + 1);
    const int32_t *const *beyond = block->beyond;
    ptrdiff_t step[8], written = 0;
    for (int corner = 0; corner < 8; corner++)
        step[corner] = (corner & 1) + (corner >> 1 & 1) * row + (corner >> 2) * plane;
    int32_t own = block->first;
    for (ptrdiff_t k = 0; k < nk; k++)
        for (ptrdiff_t j = 0; j < nj; j++) {
            const int32_t *nodes = block->nodes + k * plane + j * row;
            if (out.room - written < 6 * ni)
                return -1;
            for (ptrdiff_t i = 0; i < ni; i++, own++, nodes++) {
                face_to faces[6];
                int count = 0;
                count = i + 1 < ni ? add(faces, count, own, own + 1, 1)
                                   : add(faces, count, own, beyond[1][k * nj + j], 1);
                count = j + 1 < nj ? add(faces, count, own, own + (int32_t)ni, 3)
                                   : add(faces, count, own, beyond[3][k * ni + i], 3);
                count = k + 1 < nk ? add(faces, count, own, own + (int32_t)(ni * nj), 5)
                                   : add(faces, count, own, beyond[5][j * ni + i], 5);
                if (i == 0)
                    count = add(faces, count, own, beyond[0][k * nj + j], 0);
                if (j == 0)
                    count = add(faces, count, own, beyond[2][k * ni + i], 2);
                if (k == 0)
                    count = add(faces, count, own, beyond[4][j * ni + i], 4);
                for (int face = 0; face < count; face++, written++) {
                    const unsigned char *corners = CORNERS[faces[face].side];
                    for (int corner = 0; corner < 4; corner++)
                        out.nodes[4 * written + corner] = nodes[step[corners[corner]]];
                    out.owner[written] = own;
                    out.neighbour[written] = faces[face].cell;
                }
            }
        }
    return written;
}
