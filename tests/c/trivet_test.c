/* The C interface, from plain C99: what it finds is what the program found, in one thread and in four.
 *
 * usage: trivet_test FOLDER   (as make_data.py fills it)
 */
#include "trivet.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int num_faults = 0;

static void expect(int good, const char* what, int line) {
  if (good) return;
  fprintf(stderr, "trivet_test.c:%d: expected %s\n", line, what);
  ++num_faults;
}
#define EXPECT(condition) expect((condition) ? 1 : 0, #condition, __LINE__)

static void fail(const char* what) {
  fprintf(stderr, "trivet_test: %s\n", what);
  exit(2);
}

enum { kMostFound = 16, kThreads = 4 };

typedef struct Image {
  size_t width, height;
  trivet_camera camera;
  uint16_t* depths;
} Image;

typedef struct Found {
  size_t size;
  char model[kMostFound][128];
  double pose[kMostFound][16];
} Found;

static FILE* open_file(const char* folder, const char* name) {
  char path[4096];
  FILE* file;
  if (snprintf(path, sizeof(path), "%s/%s", folder, name) >= (int)sizeof(path)) fail("long path");
  file = fopen(path, "rb");
  if (!file) fail(path);
  return file;
}

static Image read_image(const char* folder) {
  Image image;
  unsigned long width, height;
  trivet_camera* const c = &image.camera;
  FILE* file = open_file(folder, "image.txt");
  if (fscanf(file, "%lu %lu %lf %lf %lf %lf %lf", &width, &height, &c->fx, &c->fy, &c->cx, &c->cy,
             &c->depth_scale) != 7)
    fail("image.txt");
  fclose(file);
  image.width = width;
  image.height = height;
  image.depths = malloc(width * height * sizeof(uint16_t));
  file = open_file(folder, "depths.u16");
  if (!image.depths ||
      fread(image.depths, sizeof(uint16_t), width * height, file) != width * height)
    fail("depths.u16");
  fclose(file);
  return image;
}

static Found read_found(const char* folder) {
  Found found;
  FILE* const file = open_file(folder, "found.txt");
  int k;
  found.size = 0;
  while (found.size < kMostFound && fscanf(file, "%127s", found.model[found.size]) == 1) {
    for (k = 0; k < 16; ++k)
      if (fscanf(file, "%lf", &found.pose[found.size][k]) != 1) fail("found.txt");
    ++found.size;
  }
  fclose(file);
  return found;
}

typedef struct Work {
  const trivet_library* library;
  const Image* image;
  const Found* expected;
  int same;
} Work;

static int is_same(const trivet_library* library, const trivet_result* result,
                   const Found* expected) {
  size_t i;
  trivet_detection detection;
  if (trivet_num_detections(result) != expected->size) return 0;
  for (i = 0; i < expected->size; ++i) {
    if (trivet_get_detection(result, i, &detection) != TRIVET_OK) return 0;
    if (strcmp(trivet_model_name(library, detection.model), expected->model[i]) != 0) return 0;
    if (memcmp(detection.pose, expected->pose[i], sizeof(detection.pose)) != 0) return 0;
    if (!(detection.score >= 0.8F && detection.score <= 1)) return 0;
  }
  return 1;
}

static void* recognize(void* argument) {
  Work* const work = argument;
  const Image* const image = work->image;
  trivet_result* result = NULL;
  trivet_error error;
  if (trivet_recognize_depth(work->library, image->depths, TRIVET_UINT16, image->width,
                             image->height, image->width, &image->camera, TRIVET_UNIT_OF_LIBRARY,
                             NULL, NULL, &result, &error) != TRIVET_OK) {
    fprintf(stderr, "%s\n", error.message);
    return NULL;
  }
  work->same = error.status == TRIVET_OK && error.message[0] == '\0' &&
               is_same(work->library, result, work->expected);
  trivet_free_result(result);
  return NULL;
}

static void test_threads(const trivet_library* library, const Image* image, const Found* expected) {
  pthread_t threads[kThreads];
  Work work[kThreads];
  int t;
  for (t = 0; t < kThreads; ++t) {
    Work each = {NULL, NULL, NULL, 0};
    each.library = library;
    each.image = image;
    each.expected = expected;
    work[t] = each;
    if (pthread_create(&threads[t], NULL, recognize, &work[t]) != 0) fail("cannot make a thread");
  }
  for (t = 0; t < kThreads; ++t) {
    pthread_join(threads[t], NULL);
    EXPECT(work[t].same);
  }
}

/* The same scan as points, in front of the camera: floats, so the poses are those of the image. */
static void test_points(const trivet_library* library, const Image* image, const Found* expected) {
  const char* const options[] = {"min-score=0.5", "method=ppf", NULL};
  const char* const wrong[] = {"min-score=7", NULL};
  float* const xyz = malloc(image->width * image->height * 4 * sizeof(float));
  const trivet_camera* const c = &image->camera;
  trivet_result* result = NULL;
  trivet_scene scene;
  trivet_error error;
  size_t u, v, n = 0;
  if (!xyz) fail("out of memory");
  for (v = 0; v < image->height; ++v) {
    for (u = 0; u < image->width; ++u) {
      const double z = image->depths[v * image->width + u] * c->depth_scale;
      if (!(z > 0)) continue;
      xyz[4 * n] = (float)(((double)u - c->cx) * z / c->fx);
      xyz[4 * n + 1] = (float)(((double)v - c->cy) * z / c->fy);
      xyz[4 * n + 2] = (float)z;
      xyz[4 * n + 3] = -1;
      ++n;
    }
  }
  EXPECT(trivet_recognize_points(library, xyz, TRIVET_FLOAT32, n, 1, 4, NULL,
                                 TRIVET_UNIT_OF_LIBRARY, options, NULL, &result,
                                 &error) == TRIVET_OK);
  EXPECT(trivet_num_detections(result) >= expected->size / 2);
  EXPECT(trivet_get_scene(result, &scene) == TRIVET_OK);
  EXPECT(scene.num_points == n && scene.num_invalid == 0 && scene.noise > 0 && scene.seconds > 0);
  trivet_free_result(result);
  EXPECT(trivet_recognize_points(library, xyz, TRIVET_FLOAT32, n, 1, 4, NULL,
                                 TRIVET_UNIT_OF_LIBRARY, wrong, NULL, &result,
                                 &error) == TRIVET_USAGE);
  EXPECT(!result && error.status == TRIVET_USAGE && strstr(error.message, "min-score"));
  EXPECT(trivet_recognize_points(library, xyz, TRIVET_FLOAT32, 0, 1, 4, NULL,
                                 TRIVET_UNIT_OF_LIBRARY, NULL, NULL, &result,
                                 NULL) == TRIVET_BAD_DATA);
  free(xyz);
}

/* A library that others cut off while it is open: an error of its own, and no end of the process. */
static void test_changed(const char* path, const char* folder, const Image* image) {
  char copy[4096];
  char buffer[65536];
  size_t size;
  FILE *from, *to;
  trivet_library* library = NULL;
  trivet_result* result = NULL;
  trivet_error error;
  if (snprintf(copy, sizeof(copy), "%s/changed.h5", folder) >= (int)sizeof(copy)) fail("long path");
  from = fopen(path, "rb");
  to = fopen(copy, "wb");
  if (!from || !to) fail("cannot copy the library");
  while ((size = fread(buffer, 1, sizeof(buffer), from)) > 0) fwrite(buffer, 1, size, to);
  fclose(from);
  fclose(to);
  if (trivet_open(copy, NULL, &library, &error) != TRIVET_OK) fail(error.message);
  to = fopen(copy, "wb");
  if (!to) fail("cannot cut off the library");
  fclose(to);
  EXPECT(trivet_recognize_depth(library, image->depths, TRIVET_UINT16, image->width, image->height,
                                image->width, &image->camera, TRIVET_MILLIMETER, NULL, NULL,
                                &result, &error) == TRIVET_CHANGED);
  EXPECT(!result && strstr(error.message, "changed.h5"));
  trivet_close(library);
  remove(copy);
}

int main(int argc, char** argv) {
  char path[4096];
  Image image;
  Found expected;
  trivet_library* library = NULL;
  trivet_stopper* const stopper = trivet_new_stopper();
  trivet_result* result = NULL;
  trivet_error error;
  if (argc != 2) fail("usage: trivet_test FOLDER");
  image = read_image(argv[1]);
  expected = read_found(argv[1]);
  EXPECT(expected.size >= 3);
  EXPECT(trivet_open("missing.h5", NULL, &library, &error) == TRIVET_MISSING_INPUT);
  EXPECT(!library && strstr(error.message, "missing.h5"));

  if (snprintf(path, sizeof(path), "%s/parts.h5", argv[1]) >= (int)sizeof(path)) fail("long path");
  if (trivet_open(path, NULL, &library, &error) != TRIVET_OK) fail(error.message);
  EXPECT(trivet_num_models(library) == 3);
  EXPECT(strcmp(trivet_model_name(library, 0), trivet_model_name(library, 1)) < 0);
  EXPECT(trivet_model_name(library, 3) == NULL);
  EXPECT(trivet_library_unit(library) == TRIVET_MILLIMETER);
  test_threads(library, &image, &expected);
  test_points(library, &image, &expected);

  trivet_stop(stopper);
  EXPECT(trivet_recognize_depth(library, image.depths, TRIVET_UINT16, image.width, image.height,
                                image.width, &image.camera, TRIVET_MILLIMETER, NULL, stopper,
                                &result, &error) == TRIVET_STOPPED);
  EXPECT(!result && error.message[0] != '\0');
  trivet_free_stopper(stopper);
  trivet_close(library);
  test_changed(path, argv[1], &image);
  free(image.depths);
  printf("trivet %s: %d faults\n", trivet_version(), num_faults);
  return num_faults == 0 ? 0 : 1;
}
