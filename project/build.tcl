# Makes the bitstream: vivado -mode batch -source build.tcl, in this directory or from anywhere. Non-project flow; results in build/.
#
# Fails where a step fails or has a critical warning that is not tolerated below, where a constraint names what is not there, where a memory
# image is missing, and where a report at the end says that something is unsafe, unconstrained, too slow or not where it must be.

# Critical warnings that may be, as {ID reason}. None is known to be needed.
set tolerated {
}
# Messages that are errors here whatever Vivado calls them: an image that was not opened, an object of a constraint that was not found, a
# line that is no constraint.
set errors {
    {Synth 8-4445}
    {Vivado 12-180} {Vivado 12-507} {Vivado 12-508} {Vivado 12-584} {Vivado 12-627} {Vivado 12-4739} {Vivado 12-1387}
    {Common 17-55} {Designutils 20-1307}
}

set here [file dirname [file normalize [info script]]]
set out [file join $here build]
file mkdir $out
set part xc7k325tffg900-2

proc fail {reason} {
    puts stderr "build.tcl: $reason"
    exit 1
}

# A step of the flow; critical warnings that came with it fail it.
proc step {args} {
    uplevel #0 $args
    critical [lindex $args 0]
}

proc critical {step} {
    global tolerated
    set found [get_msg_config -severity {CRITICAL WARNING} -count]
    foreach entry $tolerated {
        incr found -[get_msg_config -id [lindex $entry 0] -count]
    }
    if {$found > 0} { fail "$step: $found critical warnings, see above; what may be belongs into the list tolerated" }
}

proc files {pattern} {
    global here
    return [lsort [glob -directory $here $pattern]]
}

# A report's text, written to build/ and given back.
proc report {file args} {
    global out
    set text [uplevel #0 [concat $args -return_string]]
    set channel [open [file join $out $file] w]
    puts $channel $text
    close $channel
    return $text
}

# Vivado would go on without a memory image, with zeros in its place.
if {[file exists [file join $here manifest.json]]} {
    set manifest [open [file join $here manifest.json]]
    foreach {entry path} [regexp -all -inline {"path": "(mem/[^"]+)"} [read $manifest]] {
        if {![file exists [file join $here $path]]} { fail "$path: this memory image is missing; generate the directory again" }
    }
    close $manifest
}

create_project -in_memory -part $part
foreach id $errors { set_msg_config -id $id -new_severity ERROR }
set_property target_language Verilog [current_project]
set_property default_lib work [current_project]

# The DRAM controller, from its project file; anew where an earlier run left one.
step create_ip -name mig_7series -vendor xilinx.com -library ip -module_name mig_kc705 -dir $out -force
set_property -dict [list CONFIG.XML_INPUT_FILE [file join $here constraints mig.prj] \
    CONFIG.RESET_BOARD_INTERFACE Custom CONFIG.MIG_DONT_TOUCH_PARAM Custom CONFIG.BOARD_MIG_PARAM Custom] [get_ips mig_kc705]
step generate_target all [get_ips mig_kc705]
step synth_ip [get_ips mig_kc705]

# Memory images are found by their names among the files of the project.
step read_verilog [files rtl/*.v]
step read_mem [files mem/*.mem]
step read_xdc [file join $here constraints kc705.xdc]
step synth_design -top kc705_top -part $part -flatten_hierarchy rebuilt -verilog_define EDOF_IMAGES_BY_NAME -verilog_define SYNTHESIS
# To what synthesis left, so that each limit holds what is there.
set limits_file [file join $here constraints crossings.xdc]
step read_xdc $limits_file
# Each synchroniser of the core is the end of one of its lines: Vivado would not say so where its input has an exception, too.
set channel [open $limits_file]
set limits [read $channel]
close $channel
foreach cell [get_cells -hierarchical -filter {ORIG_REF_NAME =~ edof_sync* || REF_NAME =~ edof_sync*}] {
    set name [get_property NAME $cell]
    if {[string match core/* $name] && [string first "$name/first_q_reg" $limits] < 0} {
        fail "$name: no line of crossings.xdc ends at this synchroniser; generate the directory again"
    }
}
write_checkpoint -force [file join $out synthesised.dcp]
report_utilization -hierarchical -file [file join $out synthesised_utilization.rpt]

step opt_design
step place_design
step phys_opt_design
step route_design
step phys_opt_design
write_checkpoint -force [file join $out routed.dcp]

report_utilization -file [file join $out utilization.rpt]
report_clock_interaction -file [file join $out clocks.rpt]
report_power -file [file join $out power.rpt]
step report_timing_summary -warn_on_violation -file [file join $out timing.rpt]

foreach kind {setup hold} {
    set paths [get_timing_paths -max_paths 1 -$kind]
    if {[llength $paths] == 0} { fail "no $kind path was timed: are the clocks constrained?" }
    set slack [get_property SLACK [lindex $paths 0]]
    puts "worst $kind slack: $slack ns"
    if {$slack < 0} { fail "the worst $kind slack is $slack ns, below zero: see build/timing.rpt" }
}

# What no clock reaches and what no delay limits; the controller's pins are its own business.
set unconstrained {}
set what ""
foreach line [split [report unconstrained.rpt check_timing -verbose] "\n"] {
    if {[regexp {^\s*There (?:is|are) (\d+) (.*)\.} $line all count what]} {
        set listed 0
    } elseif {[regexp {^\S+$} [string trim $line] name] && $what ne "" && ![string match ddr3_* $name]
        && ![string match "*false path*" $what]} {
        lappend unconstrained "$name ([string trim $what])"
    }
}
if {[llength $unconstrained] > 0} { fail "unconstrained: [join $unconstrained {, }]: see build/unconstrained.rpt" }

# Every Gray-coded pointer has a limit of its skew, and keeps it.
set skews [regexp -all -line {^\d+\s+\d+\s} [report bus_skew.rpt report_bus_skew -warn_on_violation]]
critical report_bus_skew
set pointers [expr {2 * [llength [get_cells -hierarchical -filter {ORIG_REF_NAME =~ edof_async_fifo* || REF_NAME =~ edof_async_fifo*}]]}]
if {$skews != $pointers} { fail "$skews buses have a limit of their skew, expected $pointers: see build/bus_skew.rpt" }

set widths [report pulse_width.rpt report_pulse_width -all_violators -no_header]
if {[string trim $widths] ne ""} { fail "a clock's pulse is too short: see build/pulse_width.rpt" }

# Crossings of ours; those inside of the controller are its maker's.
report_cdc -details -file [file join $out cdc.rpt]
set unsafe [report cdc_critical.rpt report_cdc -details -no_header -severity Critical -cells [get_cells core]]
if {[string first Critical $unsafe] >= 0} { fail "a crossing is unsafe: see build/cdc_critical.rpt" }

report_methodology -name methodology -file [file join $out methodology.rpt]
set violations [get_methodology_violations -name methodology -filter {SEVERITY == "CRITICAL WARNING" || SEVERITY == ERROR}]
if {[llength $violations] > 0} { fail "methodology: [join $violations {, }]: see build/methodology.rpt" }

# Pixels are registered in the pads.
set pads [get_cells -hierarchical -filter {IOB == TRUE}]
if {[llength $pads] == 0} { fail "no register asks for a place in a pad" }
foreach cell $pads {
    if {![regexp {^[IO]LOGIC} [get_property LOC $cell]]} { fail "[get_property NAME $cell] is at [get_property LOC $cell], expected in its pad" }
}
# Banks 32 and 34 of the DRAM have no resistors of their own.
set cascade [get_property DCI_CASCADE [get_iobanks 33]]
if {[lsort $cascade] ne {32 34}} { fail "bank 33 gives its impedance to banks '$cascade', expected 32 and 34" }

set_property SEVERITY {Error} [get_drc_checks CFGBVS-1]
report_drc -file [file join $out drc.rpt]
set_property BITSTREAM.GENERAL.COMPRESS TRUE [current_design]
step write_bitstream -force [file join $out edof.bit]
puts "build/edof.bit is done: openFPGALoader -b kc705 build/edof.bit"
