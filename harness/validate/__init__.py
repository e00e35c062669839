"""Does a rover do what its sources say? Standard manoeuvres, each with what is expected and why."""
