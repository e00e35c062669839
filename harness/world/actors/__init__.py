"""People who walk about: who they are, the ways they go, where there is room for them. No physics."""
