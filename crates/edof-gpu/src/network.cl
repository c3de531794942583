// A frame through the network, on any device that speaks OpenCL C 1.2. Compiled twice: with FIXED for words, which are those of
// docs/contract.md bit for bit, without it for floats.
//
// Vectors of many patches stand side by side, [element][patch], `pitch` patches from one element to the next, so that neighbouring work-items
// read neighbouring words; each work-item makes ROWS elements of one patch. Weights are [input][row], rows padded to a multiple of ROWS.

#define ROWS 8

#ifdef FIXED
typedef short word;
typedef long8 sum8;
typedef int total;
#define NO_SUMS ((sum8)(0))
#define ADD_PRODUCTS(sums, weights, value) sums += convert_long8(convert_int8(vload8(0, weights)) * (int)(value))
#define STORE(sums, array) vstore8(sums, 0, array)
typedef long sum;
#else
typedef float word;
typedef float8 sum8;
typedef float total;
#define NO_SUMS ((sum8)(0.0f))
#define ADD_PRODUCTS(sums, weights, value) sums = mad(vload8(0, weights), (float8)(value), sums)
#define STORE(sums, array) vstore8(sums, 0, array)
typedef float sum;
#endif

// What stands in a patch's counters, in this order, a counter a stage; each [patch].
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

word shrunk(word b, word theta, int one_sided, int bits, uint *clipped) {
#ifdef FIXED
    int over = b, level = theta;
    int left = one_sided || over > 0 ? max(over - level, 0) : -max(-over - level, 0);
    return saturated(left, bits, clipped);
#else
    return one_sided ? fmax(b - theta, 0.0f) : copysign(fmax(fabs(b) - theta, 0.0f), b);
#endif
}

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

// ROWS products of a matrix with one patch's vector.
sum8 products(global const word *weights, int padded, global const word *vectors, int pitch, int inputs, sum8 sums) {
    for (int i = 0; i < inputs; i++)
        ADD_PRODUCTS(sums, weights + (size_t)i * padded, vectors[(size_t)i * pitch]);
    return sums;
}

// An I or M stage: b, z and what it sends. `base` is b of an earlier stage, and `before` z of the one before, where `has_base` and
// `sends_difference` say so.
kernel void stage(
    int inputs, int rows, int padded, int patches, int pitch, global const word *weights, global const word *theta,
    global const word *vectors, int has_base, int base_shift, global const word *base, int shift, int bits, int one_sided,
    int sends_difference, int has_before, global const word *before, global word *b, global word *z, global word *sent,
    volatile global uint *counts
) {
    int patch = get_global_id(0), first = get_global_id(1) * ROWS;
    if (patch >= patches) return;
    sum sums[ROWS];
    STORE(products(weights + first, padded, vectors + patch, pitch, inputs, NO_SUMS), sums);
    uint results = 0, codes = 0, differences = 0, nonzeros = 0;
    for (int i = 0; i < ROWS && first + i < rows; i++) {
        size_t at = (size_t)(first + i) * pitch + patch;
#ifdef FIXED
        word here = rounded(sums[i] + (has_base ? (long)base[at] << base_shift : 0), shift, bits, &results);
#else
        word here = sums[i] + (has_base ? base[at] : 0);
#endif
        word code = shrunk(here, theta[first + i], one_sided, bits, &codes);
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
    if (results) atomic_add(counts + SATURATED_RESULTS * pitch + patch, results);
    if (codes) atomic_add(counts + SATURATED_CODES * pitch + patch, codes);
    if (differences) atomic_add(counts + SATURATED_DIFFERENCES * pitch + patch, differences);
    if (nonzeros) atomic_add(counts + NONZEROS * pitch + patch, nonzeros);
}

// F: D z + R y, patch after patch with `rows` (a multiple of ROWS) words each.
kernel void outputs(
    int codes, int pixels, int rows, int patches, int pitch, global const word *dictionary, global const word *z,
    int dictionary_shift, int has_linear, global const word *linear, global const word *y, int linear_shift, int shift,
    global word *out, volatile global uint *counts
) {
    int patch = get_global_id(0), first = get_global_id(1) * ROWS;
    if (patch >= patches) return;
    sum8 both = products(dictionary + first, rows, z + patch, pitch, codes, NO_SUMS);
    sum words[ROWS];
#ifdef FIXED
    both <<= (long8)(dictionary_shift);
    if (has_linear) both += products(linear + first, rows, y + patch, pitch, pixels, NO_SUMS) << (long8)(linear_shift);
#else
    if (has_linear) both = products(linear + first, rows, y + patch, pitch, pixels, both);
#endif
    STORE(both, words);
    uint results = 0;
    for (int i = 0; i < ROWS; i++) {
#ifdef FIXED
        out[(size_t)patch * rows + first + i] = rounded(words[i], shift, 16, &results);
#else
        out[(size_t)patch * rows + first + i] = words[i];
#endif
    }
    if (results) atomic_add(counts + SATURATED_RESULTS * pitch + patch, results);
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
