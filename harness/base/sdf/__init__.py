"""SDF as Gazebo reads it, of worlds and robots: texts, frames, where files are, what is included."""
