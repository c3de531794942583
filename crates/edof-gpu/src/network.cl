// A frame through the network, on any device that speaks OpenCL C 1.2. Compiled twice: with FIXED for words, which are those of
// docs/contract.md bit for bit, without it for floats.
//
// Vectors of many patches stand side by side, [element][patch], `pitch` patches from one element to the next, so that neighbouring work-items
// read neighbouring words; each work-item makes ROWS elements of EACH patches (a define), so that a weight that is read is used EACH times. Weights are
// [input][row], rows padded to a multiple of ROWS.

#define ROWS 8

#ifdef FIXED
typedef short word;
typedef int8 weight8;
typedef long sum;
typedef long8 sum8;
typedef int total;
#define WEIGHTS(from) convert_int8(vload8(0, from))
#define ADD_PRODUCTS(sums, weights, value) sums += convert_long8(weights * (int)(value))
#else
typedef float word;
typedef float8 weight8;
typedef float sum;
typedef float8 sum8;
typedef float total;
#define WEIGHTS(from) vload8(0, from)
#define ADD_PRODUCTS(sums, weights, value) sums = mad(weights, (float8)(value), sums)
#endif

// The counters of a stage, in this order; `slots` of each, in which the patches count in turn.
enum { SATURATED_RESULTS, SATURATED_CODES, SATURATED_DIFFERENCES, NONZEROS };

// Index inside 0…length − 1 that stands for one outside, mirrored about the edge pixel.
int mirror(int index, int length) {
    index = abs(index);
    return index < length ? index : 2 * (length - 1) - index;
}

#ifdef FIXED
word saturated(long value, int bits, uint *clipped) {
    long largest = (1L << (bits - 1)) - 1;
    long held = clamp(value, -largest - 1, largest);
    *clipped += held != value;
    return (word)held;
}

word rounded(long value, int shift, int bits, uint *clipped) {
    return saturated(shift == 0 ? value : (value + (1L << (shift - 1))) >> shift, bits, clipped);
}
#endif

// z of a pre-activation, a function for each shrinkage; the host defines SHRUNK as the name of one.
#ifdef FIXED
word two_sided(word b, word theta, int bits, uint *clipped) {
    int over = b, level = theta;
    return saturated(over > 0 ? max(over - level, 0) : -max(-over - level, 0), bits, clipped);
}

word one_sided(word b, word theta, int bits, uint *clipped) { return saturated(max((int)b - theta, 0), bits, clipped); }

word firm(word b, word theta, int bits, uint *clipped) {
    int size = abs((int)b), left = min(2 * max(size - theta, 0), size);
    return saturated(b > 0 ? left : -left, bits, clipped);
}
#else
word two_sided(word b, word theta, int bits, uint *clipped) { return copysign(fmax(fabs(b) - theta, 0.0f), b); }

word one_sided(word b, word theta, int bits, uint *clipped) { return fmax(b - theta, 0.0f); }

word firm(word b, word theta, int bits, uint *clipped) {
    return copysign(fmin(2.0f * fmax(fabs(b) - theta, 0.0f), fabs(b)), b);
}
#endif

// Input words of the windows of some patches of a red-first frame, mirrored at its borders. One work-item a patch and pixel.
kernel void windows(
    global const ushort *raw, int height, int width, int side, int stride, int start, int first_row, int columns, int patches,
    int pitch, global word *words
) {
    int patch = get_global_id(0), pixel = get_global_id(1);
    if (patch >= patches) return;
    int row = mirror(start + (first_row + patch / columns) * stride + pixel / side, height);
    int column = mirror(start + patch % columns * stride + pixel % side, width);
    ushort value = raw[(size_t)row * width + column];
#ifdef FIXED
    words[(size_t)pixel * pitch + patch] = value >> 1;
#else
    words[(size_t)pixel * pitch + patch] = value / 65536.0f;
#endif
}

// The patches of a work-item: as many apart as there are work-items, so that those of neighbours stand side by side. Of those that there are
// not it makes the last again, and stores nothing.
int own_patch(int k) { return get_global_id(0) + k * get_global_size(0); }

// Adds to `sums` ROWS products of a matrix with the vector of each patch.
void add_products(global const word *weights, int padded, global const word *vectors, int pitch, int inputs, int patches, sum8 *sums) {
    for (int i = 0; i < inputs; i++) {
        weight8 here = WEIGHTS(weights + (size_t)i * padded);
#pragma unroll
        for (int k = 0; k < EACH; k++)
            ADD_PRODUCTS(sums[k], here, vectors[(size_t)i * pitch + min(own_patch(k), patches - 1)]);
    }
}

// An I or M stage: b, z and what it sends. `base` is b of an earlier stage, and `before` z of the one before, where `has_base` and
// `sends_difference` say so.
kernel void stage(
    int inputs, int rows, int padded, int patches, int pitch, global const word *weights, global const word *theta,
    global const word *vectors, int has_base, int base_shift, global const word *base, int shift, int bits,
    int sends_difference, int has_before, global const word *before, global word *b, global word *z, global word *sent,
    int slots, volatile global uint *counts
) {
    int first = get_global_id(1) * ROWS;
    sum8 products[EACH] = {0};
    add_products(weights + first, padded, vectors, pitch, inputs, patches, products);
#pragma unroll
    for (int k = 0; k < EACH; k++) {
        if (own_patch(k) >= patches) continue;
        sum sums[ROWS];
        vstore8(products[k], 0, sums);
        uint results = 0, codes = 0, differences = 0, nonzeros = 0;
        for (int i = 0; i < ROWS && first + i < rows; i++) {
            size_t at = (size_t)(first + i) * pitch + own_patch(k);
#ifdef FIXED
            word here = rounded(sums[i] + (has_base ? (long)base[at] << base_shift : 0), shift, bits, &results);
#else
            word here = sums[i] + (has_base ? base[at] : 0);
#endif
            word code = SHRUNK(here, theta[first + i], bits, &codes);
            word out = code;
            if (sends_difference && has_before) {
#ifdef FIXED
                out = saturated((long)code - before[at], bits, &differences);
#else
                out = code - before[at];
#endif
            }
            nonzeros += out != 0;
            b[at] = here;
            z[at] = code;
            sent[at] = out;
        }
        volatile global uint *slot = counts + own_patch(k) % slots;
        if (results) atomic_add(slot + SATURATED_RESULTS * slots, results);
        if (codes) atomic_add(slot + SATURATED_CODES * slots, codes);
        if (differences) atomic_add(slot + SATURATED_DIFFERENCES * slots, differences);
        if (nonzeros) atomic_add(slot + NONZEROS * slots, nonzeros);
    }
}

// F: D z + R y, patch after patch with `rows` (a multiple of ROWS) words each.
kernel void outputs(
    int codes, int pixels, int rows, int patches, int pitch, global const word *dictionary, global const word *z,
    int dictionary_shift, int has_linear, global const word *linear, global const word *y, int linear_shift, int shift,
    global word *out, int slots, volatile global uint *counts
) {
    int first = get_global_id(1) * ROWS;
    sum8 both[EACH] = {0};
    add_products(dictionary + first, rows, z, pitch, codes, patches, both);
#ifdef FIXED
    for (int k = 0; k < EACH; k++) both[k] <<= (long8)(dictionary_shift);
    if (has_linear) {
        sum8 of_linear[EACH] = {0};
        add_products(linear + first, rows, y, pitch, pixels, patches, of_linear);
        for (int k = 0; k < EACH; k++) both[k] += of_linear[k] << (long8)(linear_shift);
    }
#else
    if (has_linear) add_products(linear + first, rows, y, pitch, pixels, patches, both);
#endif
#pragma unroll
    for (int k = 0; k < EACH; k++) {
        if (own_patch(k) >= patches) continue;
        sum words[ROWS];
        vstore8(both[k], 0, words);
        uint results = 0;
        for (int i = 0; i < ROWS; i++) {
            size_t at = (size_t)own_patch(k) * rows + first + i;
#ifdef FIXED
            out[at] = rounded(words[i], shift, 16, &results);
#else
            out[at] = words[i];
#endif
        }
        if (results) atomic_add(counts + SATURATED_RESULTS * slots + own_patch(k) % slots, results);
    }
}

// Adds the words that some rows of patches have of one plane to its sums. The plane has `block` columns and 8 rows a patch, which start at
// `first_output`; patches are `stride` rows and `step` columns of it apart, the first at row `start` and column `left`. One work-item a column
// and row, from row `top` on.
kernel void overlap(
    global const word *out, int rows, int first_output, int block, int height, int width, int stride, int step, int start, int left,
    int first_row, int patch_rows, int columns, int top, global const float *averaging, global total *sums
) {
    int column = get_global_id(0), line = top + (int)get_global_id(1);
    if (column >= width || line >= height) return;
    int last_row = (line - start) / stride, last_column = (column - left) / step;
    int from_row = max(last_row - 8 / stride + 1, first_row), from_column = max(last_column - block / step + 1, 0);
    last_row = min(last_row, first_row + patch_rows - 1);
    last_column = min(last_column, columns - 1);
    size_t at = (size_t)line * width + column;
    total sum = sums[at];
    for (int row = from_row; row <= last_row; row++)
        for (int c = from_column; c <= last_column; c++) {
            int in = (line - start - row * stride) * block + column - left - c * step;
            word value = out[((size_t)(row - first_row) * columns + c) * rows + first_output + in];
#ifdef FIXED
            sum += value;
#else
            sum += value * averaging[in];
#endif
        }
    sums[at] = sum;
}

#ifdef FIXED
// The frame's words of its sums, and how many did not fit.
kernel void finish(global const int *sums, int length, global short *words, volatile global uint *clipped) {
    int i = get_global_id(0);
    if (i >= length) return;
    uint here = 0;
    words[i] = saturated(sums[i], 16, &here);
    if (here) atomic_inc(clipped);
}
#endif
