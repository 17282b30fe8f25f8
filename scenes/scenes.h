#pragma once
// Scenes, for a program that embeds them: read or made, drawn with colour and depth, and seen
// from many points of the lens.

#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/frame/frame.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/load/load_scene.h"
