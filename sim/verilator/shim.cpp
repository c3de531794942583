// What Rust calls. ports.inc, generated from the port list, gives zero_inputs, set_clocks, set_clock, poke_port, peek_port,
// apply_row, sample_row, INPUT_WORDS and OUTPUT_WORDS.
//
// A cycle: inputs change while the clocks are low, outputs settle (`settle`), all clocks rise (`tick`), or some of them (`rise`).
// The falling edge happens together with the next change of inputs.
#include "Vdut.h"
#include "verilated.h"
#if VM_COVERAGE
#include "verilated_cov.h"
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <unistd.h>
#endif
#include <cstdio>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <type_traits>
#if VM_TRACE_FST
#include "verilated_fst_c.h"
using Tracer = VerilatedFstC;
#elif VM_TRACE_VCD
#include "verilated_vcd_c.h"
using Tracer = VerilatedVcdC;
#endif

static constexpr uint32_t top_mask(int bits) { return bits % 32 ? (1U << bits % 32) - 1 : ~0U; }

template <int bits, class T> std::enable_if_t<std::is_integral<T>::value> put(T& to, const uint32_t* from) {
    static_assert(bits <= 64, "the port has another width");
    uint64_t value = from[0];
    if (bits > 32) value |= static_cast<uint64_t>(from[bits > 32 ? 1 : 0]) << 32;
    to = static_cast<T>(bits < 64 ? value & ((1ULL << bits % 64) - 1) : value);
}
template <int bits, std::size_t N> void put(VlWide<N>& to, const uint32_t* from) {
    static_assert(N == (bits + 31) / 32, "the port has another width");
    for (std::size_t i = 0; i < N; ++i) to[i] = from[i];
    to[N - 1] &= top_mask(bits);
}
template <int bits, class T> std::enable_if_t<std::is_integral<T>::value> get(const T& from, uint32_t* to) {
    static_assert(bits <= 64, "the port has another width");
    to[0] = static_cast<uint32_t>(from);
    if (bits > 32) to[bits > 32 ? 1 : 0] = static_cast<uint32_t>(static_cast<uint64_t>(from) >> 32);
}
template <int bits, std::size_t N> void get(const VlWide<N>& from, uint32_t* to) {
    static_assert(N == (bits + 31) / 32, "the port has another width");
    for (std::size_t i = 0; i < N; ++i) to[i] = from[i];
}

#include "ports.inc"

// The simulator reports by exception, not by ending the process.
static void stop(const char* file, int line, const char* text) {
    std::string where = file && file[0] ? std::string{file} + (line ? ":" + std::to_string(line) : "") + ": " : "";
    throw std::runtime_error(where + text);
}
void vl_fatal(const char* file, int line, const char*, const char* text) { stop(file, line, text); }
void vl_warn(const char* file, int line, const char*, const char* text) { stop(file, line, text); }
void vl_stop(const char* file, int line, const char*) { stop(file, line, "Verilog $stop"); }
void vl_finish(const char* file, int line, const char*) { stop(file, line, "Verilog $finish"); }

// One instance is made at a time: the simulator's random numbers are a matter of the whole library.
static std::mutex making;

// While an instance is made, relative paths of memory images start here. The linker sends fopen to __wrap_fopen.
static thread_local const char* memory_dir = "";
extern "C" FILE* __real_fopen(const char* path, const char* mode);
extern "C" FILE* __wrap_fopen(const char* path, const char* mode) {
    if (!*memory_dir || path[0] == '/') return __real_fopen(path, mode);
    return __real_fopen((std::string{memory_dir} + "/" + path).c_str(), mode);
}

static thread_local std::string message;

struct Model {
    std::unique_ptr<VerilatedContext> context{new VerilatedContext};
    std::unique_ptr<Vdut> top;
    uint64_t cycle = 0;
    bool settled = false;
#if VM_TRACE
    std::unique_ptr<Tracer> tracer;
    uint64_t from = 0, to = 0;
    void dump(int half) {
        if (tracer && cycle >= from && cycle <= to) tracer->dump(10 * cycle + 5 * half);
    }
    void end_trace() {
        if (tracer) tracer->close();
        tracer.reset();
    }
    ~Model() { end_trace(); }
#else
    void dump(int) {}
#endif
    void settle() {
        if (settled) return;
        top->eval();
        settled = true;
    }
    template <class F> void edge(F set) {
        settle();
        dump(0);
        set(1);
        top->eval();
        dump(1);
        set(0);
        settled = false;
        ++cycle;
#if VM_TRACE
        if (tracer && cycle > to) end_trace();
#endif
    }
    void tick() {
        edge([this](uint8_t level) { set_clocks(*top, level); });
    }
    void rise(const uint32_t* clocks, std::size_t count) {
        edge([=](uint8_t level) {
            for (std::size_t i = 0; i < count; ++i) set_clock(*top, clocks[i], level);
        });
    }
};

// 0, or 1 with the reason in `message`.
template <class F> static int guarded(Model* model, F body) {
    Verilated::threadContextp(model->context.get());
    try {
        body();
        return 0;
    } catch (const std::exception& e) { message = e.what(); }
    return 1;
}

#if VM_COVERAGE
// What the instance has covered, in a file of its own in the folder $EDOF_COVERAGE: process, moment, library and instance name it. A library may
// lie where another one lay before.
static void write_coverage(const Model& model) {
    static std::atomic<unsigned> written{0};
    const char* folder = std::getenv("EDOF_COVERAGE");
    if (!folder) return;
    const auto library = reinterpret_cast<uintptr_t>(&written);
    const auto moment = std::chrono::steady_clock::now().time_since_epoch().count();
    std::string name = std::to_string(getpid());
    for (const auto part : {uint64_t(moment), uint64_t(library), uint64_t(written++)}) name += "-" + std::to_string(part);
    model.context->coveragep()->write((std::string{folder} + "/" + name + ".dat").c_str());
}
#else
static void write_coverage(const Model&) {}
#endif

extern "C" {
#define API __attribute__((visibility("default")))
API const char* edof_message() { return message.c_str(); }

API Model* edof_create(int32_t seed, int32_t random, const char* dir) {
    const std::lock_guard<std::mutex> lock{making};
    std::unique_ptr<Model> model{new Model};
    memory_dir = dir;
    const int failed = guarded(model.get(), [&] {
        model->context->randReset(random ? 2 : 0);
        model->context->randSeed(seed);
        model->context->traceEverOn(true);
        model->top.reset(new Vdut{model->context.get()});
        set_clocks(*model->top, 0);
        zero_inputs(*model->top);
        model->settle();
    });
    memory_dir = "";
    return failed ? nullptr : model.release();
}
API void edof_destroy(Model* model) {
    Verilated::threadContextp(model->context.get());
    write_coverage(*model);
    delete model;
}
API void edof_poke(Model* model, uint32_t port, const uint32_t* words) {
    poke_port(*model->top, port, words);
    model->settled = false;
}
API void edof_peek(Model* model, uint32_t port, uint32_t* words) { peek_port(*model->top, port, words); }
API void edof_apply(Model* model, const uint32_t* row) {
    apply_row(*model->top, row);
    model->settled = false;
}
API void edof_sample(Model* model, uint32_t* row) { sample_row(*model->top, row); }
API int edof_settle(Model* model) {
    return guarded(model, [=] { model->settle(); });
}
API int edof_tick(Model* model) {
    return guarded(model, [=] { model->tick(); });
}
API int edof_rise(Model* model, const uint32_t* clocks, std::size_t count) {
    return guarded(model, [=] { model->rise(clocks, count); });
}
API int edof_run(Model* model, std::size_t cycles, const uint32_t* inputs, uint32_t* outputs) {
    return guarded(model, [=] {
        for (std::size_t i = 0; i < cycles; ++i) {
            apply_row(*model->top, inputs + i * INPUT_WORDS);
            model->settled = false;
            model->settle();
            sample_row(*model->top, outputs + i * OUTPUT_WORDS);
            model->tick();
        }
    });
}
API uint64_t edof_cycle(const Model* model) { return model->cycle; }

#if VM_TRACE
API int edof_trace(Model* model, const char* path, uint64_t from, uint64_t to) {
    return guarded(model, [=] {
        model->end_trace();
        model->from = from;
        model->to = to;
        model->tracer.reset(new Tracer);
        model->top->trace(model->tracer.get(), 99);
        model->tracer->open(path);
        if (!model->tracer->isOpen()) {
            model->tracer.reset();
            throw std::runtime_error(std::string{path} + ": cannot be written");
        }
    });
}
API void edof_end_trace(Model* model) { model->end_trace(); }
#else
API int edof_trace(Model*, const char*, uint64_t, uint64_t) {
    message = "this model was built without waveforms";
    return 1;
}
API void edof_end_trace(Model*) {}
#endif
}
