// Its load_repeating() is in dof/weights.inl now. This file goes with its last include.
