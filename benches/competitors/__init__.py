"""What openmm-helfrich is raced against: string forces, jax-md, and its own plain evaluation."""
