"""What arrived, what was rejected, what is missing."""
