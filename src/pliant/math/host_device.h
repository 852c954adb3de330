#pragma once

/// Marks a function that compiles for the CPU and for the GPU from one source.
#ifdef __CUDACC__
#define PLIANT_HOST_DEVICE __host__ __device__
#else
#define PLIANT_HOST_DEVICE
#endif

/// Keeps a rare path out of line, so that the registers it needs burden only those who take it.
#ifdef __CUDACC__
#define PLIANT_RARE_PATH __noinline__
#else
#define PLIANT_RARE_PATH __attribute__((noinline, cold))
#endif
